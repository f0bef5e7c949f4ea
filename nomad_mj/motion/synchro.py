"""How a synchro drive carries out a move: steer the wheels, then translate, never into anything.

The speed falls with the free range ahead, so that the robot can always stop before it touches.
Plain floats on purpose: this runs at every control step.
"""

import math
from dataclasses import dataclass
from enum import IntEnum

from nomad_mj.errors import ConfigError
from nomad_mj.types import MotionLimits

_STEERED = math.radians(0.25)  # the wheels point where they should
_ARRIVED = 0.004  # [m] left to go
_STILL = 0.02  # [m/s], [rad/s]
_HOLD_GAIN = 4.0  # [1/s] with which steer holds its angle
_PATIENCE = 10.0  # [s] for a robot to come to rest that should


@dataclass(frozen=True)
class MotionConfig:
    """How carefully the robot moves.

    Attributes
    ----------
    security_distance : float
        A virtual collision is something ahead that is nearer than this [m]; path finding raises
        it to what the robot's sensors can tell.
    ahead : float
        Half the angle that counts as ahead [rad].
    beside : float
        From there to a right angle things may be nearer by this [m].
    retract : float
        How far the robot backs off after a virtual collision [m], if there is room behind it.
    braking : float
        Share of the largest deceleration that the robot counts on.
    creep : float
        Speed [m/s] down to which it slows on approach.
    time_out : float
        After this [s] a move is stopped.
    """

    security_distance: float = 0.05
    ahead: float = math.radians(75)
    beside: float = 0.02
    retract: float = 0.3
    braking: float = 0.6
    creep: float = 0.05
    time_out: float = 20.0

    def __post_init__(self) -> None:
        for field, least, most in (
            ("security_distance", 0.0, math.inf),
            ("ahead", 0.0, math.pi),
            ("beside", 0.0, math.inf),
            ("retract", 0.0, math.inf),
            ("braking", 0.05, 1.0),
            ("creep", 0.01, math.inf),
            ("time_out", 0.1, math.inf),
        ):
            if not least <= getattr(self, field) <= most:
                raise ConfigError(
                    f"{field} {getattr(self, field)}: must be from {least:g} to {most:.4g}"
                )

    @property
    def longest(self) -> float:
        """No move takes longer than this, coming to rest included [s]."""
        return self.time_out + _PATIENCE


class Outcome(IntEnum):
    """How a move ended."""

    NONE = 0  # no move yet: the first time step of an episode
    MOVED = 1
    VIRTUAL_COLLISION = 2
    BUMPED = 3
    TIMED_OUT = 4


class _Phase(IntEnum):
    STEER = 0
    DRIVE = 1
    RETRACT = 2
    STOP = 3


def ramp_speed(distance: float, limit: float, acceleration: float, timestep: float) -> float:
    """Return the highest speed from which one can still stop within `distance`, in SI units."""
    if distance <= 0:
        return 0.0
    return min(limit, math.sqrt(2 * acceleration * distance), distance / timestep)


class SynchroMove:
    """One move: an endless source of motor commands until it is done.

    Parameters
    ----------
    heading : float
        Direction of the move [rad], odometry's frame.
    length : float
        Its length [m].
    wheels : float
        Present direction of the wheels [rad].
    limits, config
        Of the motors; how carefully to move.
    timestep : float
        Of control [s].

    Attributes
    ----------
    motion_heading : float
        Where the robot drives next or drives now [rad]: what is ahead lies there.
    outcome : Outcome
        NONE until the move's fate is known.
    done : bool
        The robot stands still, the move is over.
    """

    def __init__(
        self,
        heading: float,
        length: float,
        wheels: float,
        limits: MotionLimits,
        config: MotionConfig,
        timestep: float,
    ) -> None:
        turn = math.remainder(heading - wheels, 2 * math.pi)
        # Driving backwards saves steering past a right angle.
        self._sign = 1.0 if abs(turn) <= math.pi / 2 else -1.0
        if self._sign < 0:
            turn = math.remainder(turn + math.pi, 2 * math.pi)
        self._wheels = wheels + turn
        self._length = length
        self._limits, self._config, self._timestep = limits, config, timestep
        self._phase = _Phase.STEER
        self._speed = self._steer_speed = 0.0
        self._travelled = self._to_retract = 0.0
        self._elapsed = 0.0
        self._steered = self._touching = False
        self.motion_heading = heading
        self.outcome = Outcome.NONE
        self.done = False

    def command(
        self, distance: float, wheels: float, free: float, bumped: bool
    ) -> tuple[float, float]:
        """Return translation [m/s] and steering speed [rad/s] for the next control step.

        Parameters
        ----------
        distance : float
            Driven since the last call, signed along the wheels [m].
        wheels : float
            Direction of the wheels [rad].
        free : float
            Shortest reading ahead, that is about `motion_heading` [m].
        bumped : bool
            Whether a bumper was touched since the last call.
        """
        self._elapsed += self._timestep
        self._travelled += self._sign * distance
        self._judge(free, bumped, distance)
        speed = self._drive(free, distance)
        return speed, self._steer(self._wheels - wheels)

    def _judge(self, free: float, bumped: bool, distance: float) -> None:
        """Decide whether the present phase has come to its end."""
        # A contact that was there before the robot moved is not this move's, which may end it.
        touched, self._touching = bumped and not self._touching, bumped
        if self._phase is _Phase.DRIVE and touched:
            self._end(Outcome.BUMPED)
        elif self._phase is _Phase.DRIVE:
            if free < self._config.security_distance:
                self._end(Outcome.VIRTUAL_COLLISION)
            elif self._length - self._travelled <= _ARRIVED:
                self._end(Outcome.MOVED)
        elif self._phase is _Phase.RETRACT:
            left = self._travelled - self._to_retract
            if left <= _ARRIVED or free < self._config.security_distance + _ARRIVED:
                self._phase = _Phase.STOP
        if self._elapsed >= self._config.time_out and self._phase is not _Phase.STOP:
            if self.outcome is Outcome.NONE:
                self.outcome = Outcome.TIMED_OUT
            self._phase = _Phase.STOP
        if self._phase is _Phase.STOP:
            still = abs(distance) < _STILL * self._timestep and abs(self._steer_speed) < _STILL
            self.done = still or self._elapsed >= self._config.longest

    def _end(self, outcome: Outcome) -> None:
        self.outcome = outcome
        self._phase = _Phase.STOP
        if outcome is not Outcome.MOVED:
            self._phase = _Phase.RETRACT
            self._to_retract = self._travelled - self._config.retract
            self.motion_heading += math.pi

    def _steer(self, error: float) -> float:
        """Return the speed at which to turn the wheels by `error` [rad/s]."""
        limits, dt = self._limits, self._timestep
        change = limits.steer_acceleration * dt
        if self._phase is _Phase.STEER and abs(error) <= _STEERED:
            self._steered = abs(self._steer_speed) <= change
            self._phase = _Phase.DRIVE if self._steered else _Phase.STEER
        wanted = 0.0  # out of time before the wheels were there
        if self._steered:
            wanted = _HOLD_GAIN * error
        elif self._phase is _Phase.STEER:
            speed = ramp_speed(abs(error), limits.steer, 0.8 * limits.steer_acceleration, dt)
            wanted = math.copysign(speed, error)
        self._steer_speed += min(max(wanted - self._steer_speed, -change), change)
        return self._steer_speed

    def _drive(self, free: float, distance: float) -> float:
        """Return the translation speed of the present phase [m/s]."""
        limits, config, dt = self._limits, self._config, self._timestep
        braking = config.braking * limits.translate_acceleration
        wanted = 0.0
        if self._phase is _Phase.DRIVE:
            margin = free - config.security_distance - abs(distance)
            wanted = min(
                ramp_speed(self._length - self._travelled, limits.translate, braking, dt),
                ramp_speed(margin, limits.translate, braking, dt) + config.creep,
            )
        elif self._phase is _Phase.RETRACT:
            left = self._travelled - self._to_retract
            margin = free - config.security_distance - abs(distance)
            wanted = -min(
                ramp_speed(left, limits.translate, braking, dt),
                ramp_speed(margin, limits.translate, braking, dt),
            )
        change = limits.translate_acceleration * dt
        self._speed += min(max(wanted - self._speed, -change), change)
        return self._sign * self._speed
