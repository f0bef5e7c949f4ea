"""Car-like drive: it turns only while it drives, so it shuttles to and fro to face elsewhere."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from nomad_mj.motion.config import MotionConfig, Outcome
from nomad_mj.motion.drive import Move
from nomad_mj.motion.straight import StraightMove, ramp_speed
from nomad_mj.types import MotionLimits, Travel

_FACED = math.radians(3.0)  # good enough to drive off: the rest is steered away
_LEG = 0.3  # [m], longest way of a shuttle
_SHORTEST_LEG = 0.03  # [m]; a shuttle that is stopped earlier both ways is stuck


@dataclass(frozen=True)
class CarDrive:
    """Driven wheels on a fixed axle, steered wheels on the other: see `Drive`.

    The bicycle model (K. M. Lynch and F. C. Park, "Modern Robotics", 2017, section 13.3.1).

    Attributes
    ----------
    limits : MotionLimits
        Of the robot; `turn` is what it reaches at full lock.
    driven : tuple of str
        Actuators of the driven wheels.
    gains : tuple of float
        Command of each of these per speed on the floor [1/(m/s)].
    steered : tuple of str
        Actuators of the steered wheels: position servos, all at one angle [rad].
    wheelbase : float
        Between the axles [m].
    axle : float
        How far behind the robot's origin the driven axle is [m].
    lock : float
        Largest steering angle [rad].
    sees_behind : bool
        Whether range sensors look back.
    """

    limits: MotionLimits
    driven: tuple[str, ...]
    gains: tuple[float, ...]
    steered: tuple[str, ...]
    wheelbase: float
    axle: float
    lock: float
    sees_behind: bool = False
    kind = "car"

    @property
    def motors(self) -> tuple[str, ...]:
        """Driven wheels, then steered ones."""
        return self.driven + self.steered

    @property
    def encoders(self) -> tuple[str, ...]:
        """Way of each driven wheel [m], angle of each steered one [rad]."""
        return self.motors

    def travel(self, encoders: Sequence[float], heading: float) -> Travel:
        """Return what the encoders say of the robot's origin, by the bicycle model."""
        count = len(self.driven)
        way = sum(encoders[:count]) / count
        steering = sum(encoders[count:]) / len(self.steered)
        turned = way * math.tan(steering) / self.wheelbase
        return Travel(way, self.axle * turned, heading + turned, heading + turned)

    def move(
        self, heading: float, length: float, travel: Travel, config: MotionConfig, timestep: float
    ) -> Move:
        """Return a move: shuttle until the robot faces the target, then drive there."""
        return _CarMove(self, heading, length, travel, config, timestep)

    def twist(
        self, forward: float, sideways: float, turn: float, travel: Travel
    ) -> tuple[float, ...]:
        """Return the motors' commands; without driving it cannot turn."""
        steering = 0.0
        if forward:
            steering = math.atan(self.wheelbase * turn / forward)
        return self.steer(forward, steering)

    def steer(self, speed: float, steering: float) -> tuple[float, ...]:
        """Return the motors' commands for a speed [m/s] and a steering angle [rad]."""
        steering = min(max(steering, -self.lock), self.lock)
        return *(speed * gain for gain in self.gains), *([steering] * len(self.steered))


class _CarMove(Move):
    """Shuttle, then a straight move from where that has led."""

    def __init__(
        self,
        drive: CarDrive,
        heading: float,
        length: float,
        travel: Travel,
        config: MotionConfig,
        timestep: float,
    ) -> None:
        self._drive, self._config, self._timestep = drive, config, timestep
        self._x, self._y = length * math.cos(heading), length * math.sin(heading)  # to go
        self._facing = travel.heading
        self._shuttle: _Shuttle | None = None
        self._start(travel.heading)
        if abs(self._error(travel.heading)) > _FACED:
            self._shuttle = _Shuttle(drive, config, timestep)

    def _start(self, facing: float, elapsed: float = 0.0) -> None:
        """Begin to drive to where the target is from here."""
        self.straight = StraightMove(
            math.atan2(self._y, self._x),
            math.hypot(self._x, self._y),
            facing,
            self._drive.limits,
            self._config,
            self._timestep,
            reverses=self._drive.sees_behind,
            turns_first=False,
            elapsed=elapsed,
        )

    def _error(self, facing: float) -> float:
        """Return by how much to turn to have the target ahead or, seeing there, behind [rad]."""
        error = math.remainder(math.atan2(self._y, self._x) - facing, 2 * math.pi)
        if self._drive.sees_behind and abs(error) > math.pi / 2:
            error -= math.copysign(math.pi, error)
        return error

    @property
    def motion_heading(self) -> float:
        if self._shuttle is not None:
            return self._facing + (0.0 if self._shuttle.direction > 0 else math.pi)
        return self.straight.motion_heading

    def command(self, travel: Travel, free: float, bumped: bool) -> tuple[float, ...]:
        self._facing = travel.heading
        cos, sin = math.cos(travel.heading), math.sin(travel.heading)
        self._x -= travel.forward * cos - travel.sideways * sin
        self._y -= travel.forward * sin + travel.sideways * cos
        if self._shuttle is not None:
            error = self._error(travel.heading)
            speed, steering = self._shuttle.command(error, travel.forward, free, bumped)
            if not self._shuttle.over:
                return self._drive.steer(speed, steering)
            outcome = self._shuttle.outcome
            self._start(travel.heading, self._shuttle.elapsed)
            self._shuttle = None
            if outcome is not Outcome.NONE:
                self.straight.stop(outcome)
            travel = travel._replace(forward=0.0, sideways=0.0)
        speed, turn = self.straight.command(travel.forward, travel.heading, free, bumped)
        return self._drive.twist(speed, 0.0, turn, travel)


class _Shuttle:
    """Turns a car: forward at full lock, backward at the other, until it faces its target."""

    def __init__(self, drive: CarDrive, config: MotionConfig, timestep: float) -> None:
        self._drive, self._config, self._timestep = drive, config, timestep
        self.direction = 1.0
        self.over = False
        self.outcome = Outcome.NONE
        self.elapsed = self._way = self._speed = 0.0
        self._last = math.inf  # way of the leg before
        self._stopping = False

    def command(
        self, error: float, forward: float, free: float, bumped: bool
    ) -> tuple[float, float]:
        """Return speed [m/s] and steering angle [rad]; arguments as of `Move.command`.

        `error` is by how much to turn [rad].
        """
        self.elapsed += self._timestep
        self._way += self.direction * forward
        config, limits, dt = self._config, self._drive.limits, self._timestep
        braking = config.braking * limits.translate_acceleration
        margin = free - config.security_distance - abs(forward)
        radius = self._drive.wheelbase / math.tan(self._drive.lock)
        left = min(_LEG - self._way, abs(error) * radius)
        blocked = margin <= 0 or bumped
        faced = abs(error) <= _FACED
        late = self.elapsed >= config.time_out
        self._stopping |= faced or late or blocked or left <= 0.005
        wanted = 0.0
        if not self._stopping:
            wanted = self.direction * min(
                ramp_speed(left, limits.translate, braking, dt),
                ramp_speed(margin, limits.translate, braking, dt),
            )
        change = limits.translate_acceleration * dt
        self._speed += min(max(wanted - self._speed, -change), change)
        if self._stopping and abs(self._speed) < 1e-9:
            self._turn_round(faced, late)
        lock = math.copysign(self._drive.lock, error) * self.direction
        return self._speed, lock

    def _turn_round(self, faced: bool, late: bool) -> None:
        """End the leg: begin the next one, or have done."""
        stuck = max(self._way, self._last) < _SHORTEST_LEG
        self.over = faced or late or stuck
        if not faced and late:
            self.outcome = Outcome.TIMED_OUT
        elif not faced and stuck:
            self.outcome = Outcome.VIRTUAL_COLLISION
        self._last, self._way = self._way, 0.0
        self.direction = -self.direction
        self._stopping = False
