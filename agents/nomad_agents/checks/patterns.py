"""Test patterns: how far a robot gets from where it should be, and from where it believes it is."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import nomad_mj
from nomad_mj.motion import CarDrive, MotionConfig, Outcome, ramp_speed
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.tasks import MotorEnvironment, RangeNoise
from nomad_mj.types import Travel

_SIDE = 2.0  # [m] of the square, and length of the straight way
_START = (4.0, 4.0, 0.0)
_ROOM = "empty_room"
_CAREFUL = 0.5  # of the largest speed of turning
_PATIENCE = 60.0  # [s] for a pattern


class Drift(NamedTuple):
    """What became of a test pattern.

    Attributes
    ----------
    name : str
        Of the pattern.
    off_target : float
        From the robot to where it should be [m].
    off_odometry, off_heading : float
        From the robot to where its odometry puts it [m], and in heading [rad].
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
    off_odometry: float
    off_heading: float
    turned: float
    stretch: float
    seconds: float
    finished: bool


class _Driver:
    """Drives a robot by its odometry, in an empty room."""

    def __init__(self, env: MotorEnvironment) -> None:
        self.env = env
        self.step = env.reset(seed=0, start=_START)
        self.ticks = 0
        self.turned = 0.0

    @property
    def travel(self) -> Travel:
        """Way of the last control step, directions by odometry."""
        _, _, heading, sensors = self.step.observation["odometry"].tolist()
        return self.env.task.travel._replace(heading=heading, sensors=sensors)

    def command(self, speeds: tuple[float, ...]) -> None:
        """Go on by a control step."""
        before = self.travel.heading
        self.step = self.env.step(speeds)
        self.turned += math.remainder(self.travel.heading - before, 2 * math.pi)
        self.ticks += 1

    def go_to(self, x: float, y: float) -> bool:
        """Drive straight to a place [m]; return whether the robot believes it is there."""
        at = self.step.observation["odometry"]
        dx, dy = x - at[0], y - at[1]
        drive = self.env.task.scene.robot.drive
        travel = self.travel._replace(forward=0.0, sideways=0.0)
        config = MotionConfig(time_out=_PATIENCE)
        move = drive.move(math.atan2(dy, dx), math.hypot(dx, dy), travel, config, CONTROL_TIMESTEP)
        while True:
            command = move.command(travel, math.inf, False)
            if move.done:
                return move.outcome is Outcome.MOVED
            self.command(command)
            travel = self.travel

    def turn(self, angle: float) -> bool:
        """Turn by an angle [rad]: on the spot, or as tightly as a car can."""
        drive = self.env.task.scene.robot.drive
        limits, dt = drive.limits, CONTROL_TIMESTEP
        speed = 0.0
        tight = isinstance(drive, CarDrive)
        forward = limits.translate * _CAREFUL * 0.5 if tight else 0.0
        top = limits.turn * _CAREFUL
        if isinstance(drive, CarDrive):
            top = forward * math.tan(drive.lock) / drive.wheelbase
        while angle - self.turned > 1e-4 or abs(speed) > 1e-3:
            wanted = ramp_speed(angle - self.turned, top, 0.5 * limits.turn_acceleration, dt)
            change = limits.turn_acceleration * dt
            speed += min(max(wanted - speed, -change), change)
            self.command(drive.twist(forward * speed / top, 0.0, speed, self.travel))
            if self.ticks * dt > _PATIENCE:
                return False
        return True

    def drift(self, name: str, target: tuple[float, float] | None, finished: bool) -> Drift:
        """Return how far off the robot is, once it stands."""
        at = self.env.physics.pose()
        x, y, heading, _ = self.step.observation["odometry"].tolist()
        target = target or (at.x, at.y)
        return Drift(
            name,
            math.hypot(at.x - target[0], at.y - target[1]),
            math.hypot(at.x - x, at.y - y),
            math.remainder(at.heading - heading, 2 * math.pi),
            self.turned,
            math.hypot(at.x - _START[0], at.y - _START[1])
            / max(math.hypot(x - _START[0], y - _START[1]), 1e-6),
            self.ticks * CONTROL_TIMESTEP,
            finished,
        )


def _straight(driver: _Driver) -> Drift:
    end = (_START[0] + _SIDE, _START[1])
    return driver.drift(f"straight, {_SIDE:g} m", end, driver.go_to(*end))


def _turn(driver: _Driver) -> Drift:
    tight = isinstance(driver.env.task.scene.robot.drive, CarDrive)
    done = driver.turn(2 * math.pi)
    if tight:
        return driver.drift("full circle at full lock", None, done)
    return driver.drift("turn by 360 deg", _START[:2], done)


def _square(driver: _Driver) -> Drift:
    x, y, _ = _START
    corners = [(x + _SIDE, y), (x + _SIDE, y + _SIDE), (x, y + _SIDE), (x, y)]
    reached = [driver.go_to(*corner) for corner in corners]
    return driver.drift(f"square of {_SIDE:g} m", (x, y), all(reached))


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
