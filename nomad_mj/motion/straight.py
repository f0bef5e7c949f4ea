"""A straight move: turn towards it, then drive, never into anything.

The speed falls with the free range ahead, so that the robot can always stop before it touches.
Plain floats on purpose: this runs at every control step.
"""

import math
from enum import IntEnum

from nomad_mj.motion.config import MotionConfig, Outcome
from nomad_mj.types import MotionLimits

_TURNED = math.radians(0.25)  # the robot drives where it should
_ARRIVED = 0.004  # [m] left to go
_CLEAR = 0.1  # [m] back from a contact; sooner the same bumper may close again
_STILL = 0.02  # [m/s], [rad/s]
_HOLD_GAIN = 4.0  # [1/s] with which the direction is held


class _Phase(IntEnum):
    TURN = 0
    DRIVE = 1
    RETRACT = 2
    STOP = 3


def ramp_speed(distance: float, limit: float, acceleration: float, timestep: float) -> float:
    """Return the highest speed from which one can still stop within `distance`, in SI units."""
    if distance <= 0:
        return 0.0
    return min(limit, math.sqrt(2 * acceleration * distance), distance / timestep)


class StraightMove:
    """One move: an endless source of speeds until it is done.

    Parameters
    ----------
    heading : float
        Direction of the move [rad], odometry's frame.
    length : float
        Its length [m].
    facing : float
        Direction in which the robot drives at present [rad]: that of a synchro drive's wheels,
        that of any other robot.
    limits, config
        Of the robot; how carefully to move.
    timestep : float
        Of control [s].
    reverses : bool
        Whether the robot may drive backwards where it has not just been: it sees behind itself.
    turns_first : bool
        Whether it turns on the spot first; else it drives off at once and turns as it goes.
    elapsed : float
        How long the move has taken already [s].

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
        facing: float,
        limits: MotionLimits,
        config: MotionConfig,
        timestep: float,
        *,
        reverses: bool = True,
        turns_first: bool = True,
        elapsed: float = 0.0,
    ) -> None:
        turn = math.remainder(heading - facing, 2 * math.pi)
        # Driving backwards saves turning past a right angle.
        self._sign = 1.0 if abs(turn) <= math.pi / 2 or not reverses else -1.0
        if self._sign < 0:
            turn = math.remainder(turn + math.pi, 2 * math.pi)
        self._facing = facing + turn
        self._reverses = reverses
        self._length = length
        self._limits, self._config, self._timestep = limits, config, timestep
        self._phase = _Phase.TURN if turns_first else _Phase.DRIVE
        self._speed = self._turn_speed = 0.0
        self._travelled = self._to_retract = self._ended_at = 0.0
        self._elapsed = elapsed
        self._turned = not turns_first
        self.motion_heading = heading
        self.outcome = Outcome.NONE
        self.done = False

    def command(
        self, distance: float, facing: float, free: float, bumped: bool
    ) -> tuple[float, float]:
        """Return the speeds of driving [m/s] and turning [rad/s] for the next control step.

        Parameters
        ----------
        distance : float
            Driven since the last call, signed along `facing` [m].
        facing : float
            Direction in which the robot drives when it drives forward [rad].
        free : float
            Shortest reading ahead, that is about `motion_heading` [m].
        bumped : bool
            Whether a bumper has been touched since the last call that was not before.
        """
        self._elapsed += self._timestep
        self._travelled += self._sign * distance
        self._judge(free, bumped, distance)
        speed = self._drive(free, distance)
        return speed, self._turn(self._facing - facing)

    def stop(self, outcome: Outcome) -> None:
        """End the move here with an outcome, however far it has come."""
        self.outcome = outcome
        self._phase = _Phase.STOP

    def _judge(self, free: float, bumped: bool, distance: float) -> None:
        """Decide whether the present phase has come to its end."""
        if self._phase is _Phase.DRIVE and bumped:
            self._end(Outcome.BUMPED)
        elif self._phase is _Phase.DRIVE:
            if free < self._config.security_distance:
                self._end(Outcome.VIRTUAL_COLLISION)
            elif self._length - self._travelled <= _ARRIVED:
                self._end(Outcome.MOVED)
        elif self._phase is _Phase.RETRACT:
            left = self._travelled - self._to_retract
            backed = self._ended_at - self._travelled > _CLEAR and bumped
            if backed or left <= _ARRIVED or free < self._config.security_distance + _ARRIVED:
                self._phase = _Phase.STOP
        if self._elapsed >= self._config.time_out and self._phase is not _Phase.STOP:
            if self.outcome is Outcome.NONE:
                self.outcome = Outcome.TIMED_OUT
            self._phase = _Phase.STOP
        if self._phase is _Phase.STOP:
            still = abs(distance) < _STILL * self._timestep and abs(self._turn_speed) < _STILL
            self.done = still or self._elapsed >= self._config.longest

    def _end(self, outcome: Outcome) -> None:
        self.outcome = outcome
        self._phase = _Phase.STOP
        if outcome is not Outcome.MOVED:
            self._phase = _Phase.RETRACT
            self._ended_at = self._travelled
            self._to_retract = self._travelled - self._config.retract
            if not self._reverses:  # there it has just been
                self._to_retract = max(self._to_retract, 0.0)
            self.motion_heading += math.pi

    def _turn(self, error: float) -> float:
        """Return the speed at which to turn by `error` [rad/s]."""
        limits, dt = self._limits, self._timestep
        change = limits.turn_acceleration * dt
        if self._phase is _Phase.TURN and abs(error) <= _TURNED:
            self._turned = abs(self._turn_speed) <= change
            self._phase = _Phase.DRIVE if self._turned else _Phase.TURN
        wanted = 0.0  # out of time before it faced there
        if self._turned:
            wanted = _HOLD_GAIN * error
        elif self._phase is _Phase.TURN:
            speed = ramp_speed(abs(error), limits.turn, 0.8 * limits.turn_acceleration, dt)
            wanted = math.copysign(speed, error)
        self._turn_speed += min(max(wanted - self._turn_speed, -change), change)
        return self._turn_speed

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
