"""From keys that are held to speeds that a robot can follow: pure, without physics or clock."""

import math
from collections.abc import Iterable
from typing import NamedTuple

from nomad_mj.errors import UnknownNameError
from nomad_mj.types import MotionLimits

PATIENCE = 0.5  # [s] without any word from the keyboard after which the robot stops


class Wish(NamedTuple):
    """What the driver wants: shares of the robot's largest speeds, in [-1, 1].

    Attributes
    ----------
    forward, sideways, turn : float
        Ahead, to the left, and turning left.
    """

    forward: float = 0.0
    sideways: float = 0.0
    turn: float = 0.0


class Twist(NamedTuple):
    """Speeds of a robot: `forward`, `sideways` (to the left) [m/s], `turn` (left) [rad/s]."""

    forward: float = 0.0
    sideways: float = 0.0
    turn: float = 0.0


KEYS = {
    "forward": Wish(forward=1.0),
    "back": Wish(forward=-1.0),
    "left": Wish(turn=1.0),
    "right": Wish(turn=-1.0),
    "aside_left": Wish(sideways=1.0),
    "aside_right": Wish(sideways=-1.0),
}
"""What each key means by itself."""


def wish_of(held: Iterable[str]) -> Wish:
    """Return what keys that are held together mean; opposite ones cancel.

    Raises
    ------
    UnknownNameError
        A key that is not one of `KEYS`.
    """
    sums = [0.0, 0.0, 0.0]
    for name in set(held):
        if name not in KEYS:
            raise UnknownNameError("key", name, KEYS)
        sums = [total + share for total, share in zip(sums, KEYS[name], strict=True)]
    return Wish(*(min(max(total, -1.0), 1.0) for total in sums))


class Teleoperator:
    """Turns wishes into speeds: none changes faster than the robot's motors can follow.

    Parameters
    ----------
    limits : MotionLimits
        Of the robot.
    timestep : float
        Between two calls of `twist` [s].
    wheel : bool
        Whether turning is done with a steering wheel, as in a car: backing up with the wheel to
        the left turns the robot to the right.
    """

    def __init__(self, limits: MotionLimits, timestep: float, *, wheel: bool = False) -> None:
        self._limits, self._timestep, self._wheel = limits, timestep, wheel
        self._twist = Twist()
        self._wish, self._heard = Wish(), -math.inf

    def hold(self, wish: Wish, now: float) -> None:
        """Take in what the driver wants at the time `now` [s]."""
        self._wish, self._heard = wish, now

    def halt(self) -> None:
        """Forget the wish and all speed: the robot stands, as after a reset."""
        self._wish, self._twist = Wish(), Twist()

    def twist(self, now: float) -> Twist:
        """Return the speeds for the next control step, at the time `now` [s].

        The wish of a driver who has not been heard of for `PATIENCE` is to stand.
        """
        wish = self._wish if now - self._heard < PATIENCE else Wish()
        limits, before = self._limits, self._twist
        reach = max(math.hypot(wish.forward, wish.sideways), 1.0)  # no faster on a diagonal
        change = limits.translate_acceleration * self._timestep
        ahead = limits.translate * wish.forward / reach - before.forward
        aside = limits.translate * wish.sideways / reach - before.sideways
        share = min(change / max(math.hypot(ahead, aside), 1e-12), 1.0)
        forward = before.forward + share * ahead
        sideways = before.sideways + share * aside
        side = -1.0 if self._wheel and forward < 0 else 1.0
        wanted = side * limits.turn * wish.turn
        swing = limits.turn_acceleration * self._timestep
        turn = before.turn + min(max(wanted - before.turn, -swing), swing)
        self._twist = Twist(forward, sideways, turn)
        return self._twist
