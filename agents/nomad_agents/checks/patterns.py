"""Test patterns: how far a robot gets from where it should be, and from where it believes it is."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import nomad_mj
from nomad_mj.motion import CarDrive, MotionConfig, Outcome, WheeledDrive, ramp_speed
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.tasks import MotorEnvironment, RangeNoise
from nomad_mj.types import Travel

_SIDE = 2.0  # [m] of the square, and length of the straight way
_START = (4.0, 4.0, 0.0)
_ROOM = "empty_room"
_CAREFUL = 0.5  # of the largest speed of turning
_PATIENCE = 60.0  # [s] for a pattern
_CLOSING = 4.0  # [1/s] with which the last millimetres and the last degrees are made good
_CLOSE, _FACING = 2e-4, math.radians(0.02)  # [m], [rad]
_SETTLING, _REST = 5.0, 0.5  # [s] at most to close in; to stand before it is measured
_TURNED = math.radians(1)  # that a turn may be off by and still count as finished


class Drift(NamedTuple):
    """What became of a test pattern.

    Attributes
    ----------
    name : str
        Of the pattern.
    off_target : float
        From the robot to where it should be [m], measured at the place about which it turns.
    off_facing : float
        By how much it faces too far to the left [rad]; 0 where a car cannot choose.
    off_odometry, off_heading : float
        From the robot to where its odometry puts it [m]; and by how much more it has turned left
        than odometry tells [rad], whole turns counted.
    turned : float
        By how much odometry has turned [rad].
    stretch : float
        True distance from the start per distance by odometry.
    seconds : float
        It took [s of simulated time].
    finished : bool
        Whether it came to its end.
    """

    name: str
    off_target: float
    off_facing: float
    off_odometry: float
    off_heading: float
    turned: float
    stretch: float
    seconds: float
    finished: bool


class _Driver:
    """Drives a robot by its odometry, in an empty room.

    A move ends a few millimetres before its target, which is well enough for finding a path; here
    what is left is driven as well, so that what is off afterwards is odometry's.
    """

    def __init__(self, env: MotorEnvironment) -> None:
        self.env = env
        self.drive = env.task.scene.robot.drive
        self.step = env.reset(seed=0, start=_START)
        self.ticks = 0
        self.turned = self.truly = 0.0  # [rad] by odometry and in truth, whole turns counted

    @property
    def travel(self) -> Travel:
        """Way of the last control step, directions by odometry."""
        _, _, heading, sensors = self.step.observation["odometry"].tolist()
        return self.env.task.travel._replace(heading=heading, sensors=sensors)

    def command(self, speeds: tuple[float, ...]) -> None:
        """Go on by a control step."""
        before, truly = self.travel.heading, self.env.physics.pose().heading
        self.step = self.env.step(speeds)
        self.turned += math.remainder(self.travel.heading - before, 2 * math.pi)
        self.truly += math.remainder(self.env.physics.pose().heading - truly, 2 * math.pi)
        self.ticks += 1

    def centre(self, x: float, y: float, heading: float) -> tuple[float, float]:
        """Return the place that stays where it is as a robot at a pose turns on the spot [m]."""
        back = self.drive.axle if isinstance(self.drive, WheeledDrive) else 0.0
        return x - back * math.cos(heading), y - back * math.sin(heading)

    def _to_go(self, x: float, y: float) -> tuple[float, float]:
        """Return how far it is by odometry from the robot's centre to a place [m], in the world."""
        at_x, at_y = self.centre(*self.step.observation["odometry"].tolist()[:3])
        return x - at_x, y - at_y

    def go_to(self, x: float, y: float) -> bool:
        """Drive the centre straight to a place [m]; return whether it is there by odometry."""
        dx, dy = self._to_go(x, y)
        travel = self.travel._replace(forward=0.0, sideways=0.0)
        config = MotionConfig(time_out=_PATIENCE)
        drive = self.drive  # to which the centre of turning is its origin here
        if isinstance(drive, WheeledDrive):
            drive = replace(drive, axle=0.0)
        move = drive.move(math.atan2(dy, dx), math.hypot(dx, dy), travel, config, CONTROL_TIMESTEP)
        while True:
            command = move.command(travel, math.inf, False)
            if move.done:
                break
            self.command(command)
            travel = self.travel
        self._close_in(x, y)
        return move.outcome is Outcome.MOVED

    def _close_in(self, x: float, y: float) -> None:
        """Drive the last millimetres to a place [m], as far as that needs no turn."""
        aside = self.drive.kind == "omni"
        for _ in range(round(_SETTLING / CONTROL_TIMESTEP)):
            dx, dy = self._to_go(x, y)
            cos, sin = math.cos(self.travel.heading), math.sin(self.travel.heading)
            ahead, left = dx * cos + dy * sin, (dy * cos - dx * sin) * aside
            if math.hypot(ahead, left) < _CLOSE:
                break
            self.command(self.drive.twist(_CLOSING * ahead, _CLOSING * left, 0.0, self.travel))
        self._stand()

    def turn(self, angle: float) -> bool:
        """Turn until odometry has turned by an angle since the start [rad].

        On the spot, or as tightly as a car can; return whether that came to its end.
        """
        limits, dt = self.drive.limits, CONTROL_TIMESTEP
        forward, top = 0.0, limits.turn * _CAREFUL
        if isinstance(self.drive, CarDrive):
            forward = limits.translate * _CAREFUL * 0.5
            top = forward * math.tan(self.drive.lock) / self.drive.wheelbase
        speed, change = 0.0, limits.turn_acceleration * dt
        for _ in range(round(_PATIENCE / dt)):
            left = angle - self.turned
            if abs(left) < _FACING and abs(speed) <= change:
                break
            wanted = ramp_speed(abs(left), top, 0.5 * limits.turn_acceleration, dt)
            wanted = math.copysign(min(wanted, _CLOSING * abs(left)), left)
            speed += min(max(wanted - speed, -change), change)
            self.command(self.drive.twist(forward * speed / top, 0.0, speed, self.travel))
        self._stand()
        return abs(angle - self.turned) < _TURNED

    def _stand(self) -> None:
        """Come to rest."""
        for _ in range(round(_REST / CONTROL_TIMESTEP)):
            self.command(self.drive.twist(0.0, 0.0, 0.0, self.travel))

    def drift(
        self,
        name: str,
        finished: bool,
        place: tuple[float, float] | None,
        facing: float | None,
    ) -> Drift:
        """Return how far off the robot is, once it stands, from a place [m] and a direction [rad].

        None stands for what the robot could not choose.
        """
        at = self.env.physics.pose()
        x, y, _, _ = self.step.observation["odometry"].tolist()
        centre = self.centre(at.x, at.y, at.heading)
        return Drift(
            name,
            math.dist(centre, place or centre),
            0.0 if facing is None else math.remainder(at.heading - facing, 2 * math.pi),
            math.hypot(at.x - x, at.y - y),
            self.truly - self.turned,
            self.turned,
            math.hypot(at.x - _START[0], at.y - _START[1])
            / max(math.hypot(x - _START[0], y - _START[1]), 1e-6),
            self.ticks * CONTROL_TIMESTEP,
            finished,
        )


def _straight(driver: _Driver) -> Drift:
    x, y = driver.centre(*_START)
    end = (x + _SIDE, y)
    return driver.drift(f"straight, {_SIDE:g} m", driver.go_to(*end), end, _START[2])


def _turn(driver: _Driver) -> Drift:
    done = driver.turn(2 * math.pi)
    if isinstance(driver.drive, CarDrive):
        return driver.drift("full circle at full lock", done, None, _START[2])
    return driver.drift("turn by 360 deg", done, driver.centre(*_START), _START[2])


def _square(driver: _Driver) -> Drift:
    """Drive to the corners, and face as at first."""
    x, y = driver.centre(*_START)
    corners = [(x + _SIDE, y), (x + _SIDE, y + _SIDE), (x, y + _SIDE), (x, y)]
    reached = [driver.go_to(*corner) for corner in corners]
    facing = None if isinstance(driver.drive, CarDrive) else _START[2]
    if facing is not None:
        turns = round(driver.turned / (2 * math.pi))
        reached.append(driver.turn(2 * math.pi * turns))
    return driver.drift(f"square of {_SIDE:g} m", all(reached), (x, y), facing)


_PATTERNS: tuple[Callable[[_Driver], Drift], ...] = (_straight, _turn, _square)


def drive_patterns(robot: str | Path) -> list[Drift]:
    """Drive a robot straight, round and along a square, in an empty room without noise.

    Parameters
    ----------
    robot : str or Path
        A name or an MJCF file.

    Raises
    ------
    NomadError
        Anything wrong with the file.
    """
    options = {"range_noise": RangeNoise("none", 0.0), "ends_at_goal": False, "random": 0}
    time_limit = {"time_limit": math.inf}
    with nomad_mj.load("motor", _ROOM, robot, options, time_limit) as env:
        return [pattern(_Driver(env)) for pattern in _PATTERNS]
