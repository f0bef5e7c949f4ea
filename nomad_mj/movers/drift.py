"""How a thing moves about: a general direction, followed in a random way."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from nomad_mj.errors import ConfigError


@dataclass(frozen=True)
class Drift:
    """Motion in a general direction, with random speed and random sideways parts.

    Whenever `period` is over, the speed is drawn anew from U(0, speed) and the heading from
    U(direction - spread, direction + spread). Where it cannot go on, it turns back and has the
    opposite general direction from then on.

    Attributes
    ----------
    direction : float
        General direction [rad], 0 along +x, counter-clockwise.
    speed : float or None
        Largest speed [m/s]; None for half of the robot's top speed.
    spread : float
        Half the angle that the heading may stray from the general direction [rad], 0 to pi.
    period : float
        Time between two draws [s].
    """

    direction: float
    speed: float | None = None
    spread: float = math.pi / 3
    period: float = 2.0

    def __post_init__(self) -> None:
        check_number("direction", self.direction, -math.inf, " rad: must be finite")
        if self.speed is not None:
            check_number("largest speed", self.speed, 0, " m/s: must be above 0")
        if self.spread != 0:
            check_number("spread", self.spread, 0, " rad: must be 0 to pi")
        if self.spread > math.pi:
            raise ConfigError(f"spread {self.spread} rad: must be 0 to pi")
        check_number("period", self.period, 0, " s: must be above 0")


@dataclass(frozen=True)
class MovingGoal(Drift):
    """A goal that moves, by default to the left, as in Fig 11 of the paper."""

    direction: float = math.pi


@dataclass(frozen=True)
class MovingObstacles(Drift):
    """Upright cylinders that move, by default to the bottom, as in Fig 12 of the paper.

    Each starts anywhere in the room, clear of the robot and of everything else.

    Attributes
    ----------
    count : int
        How many.
    radius, height : float
        Of each [m]. The Nomad's sonars look out at 0.69 m and see nothing lower.
    """

    direction: float = -math.pi / 2
    count: int = 4
    radius: float = 0.25
    height: float = 0.9

    def __post_init__(self) -> None:
        super().__post_init__()
        count: Any = self.count
        if not isinstance(count, int | np.integer) or isinstance(count, bool) or count < 0:
            raise ConfigError(f"count of moving obstacles {count!r}: must be 0, 1, 2, ...")
        check_number("radius of moving obstacles", self.radius, 0, " m: must be above 0")
        check_number("height of moving obstacles", self.height, 0, " m: must be above 0")


def check_number(name: str, value: Any, above: float, told: str) -> None:
    """Raise a ConfigError unless a value is a finite number above a limit."""
    number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    if not (number and math.isfinite(value) and value > above):
        raise ConfigError(f"{name} {value!r}{told}")
