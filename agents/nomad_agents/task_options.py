"""The options that say where the robot drives and how its sensors err, shared by commands."""

import math
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, fields
from typing import Any

import nomad_mj
from nomad_mj import (
    BumperNoise,
    Crosstalk,
    FiringOrder,
    Gyroscope,
    InfraredEffects,
    MovingGoal,
    MovingObstacles,
    OdometryNoise,
    RangeNoise,
    SonarEffects,
)
from nomad_mj.envs import DEFAULT_ROBOT, DEFAULT_ROOM, PathFinding
from nomad_mj.errors import CheckpointError, ConfigError

_EVERY_ECHO = 90.0  # [deg]


@dataclass(frozen=True)
class TaskOptions:
    """What a command inherits to have them; they become the arguments of `nomad_mj.load`."""

    room: str = DEFAULT_ROOM
    """Name of a room, or an MJCF file."""
    robot: str = DEFAULT_ROBOT
    """Name of a robot, or an MJCF file."""
    goal: str = ""
    """X,Y: where the goal is, in metres, in place of the room's own."""
    moving_goal: bool = False
    """The goal drifts to the left."""
    moving_obstacles: int = 0
    """So many obstacles, beside those of the room, drift to the bottom."""
    range_noise: float = 0.15
    """Range readings err by up to this share of the distance."""
    gaussian_noise: bool = False
    """They err by a normal distribution, of which --range-noise is the standard deviation."""
    grazing: float = _EVERY_ECHO
    """Sonar echoes of what is struck farther from square on than this, in degrees, are lost."""
    odometry_error: float = 0.0
    """The position by odometry is wrong by up to this in x and y, in metres, anew each time."""
    sonar_per_step: int = 0
    """So many sonars fire in a control step, the others keep their last readings; 0 for all."""
    spread_firing: bool = False
    """Sonars that fire together are far apart, not neighbours; with --sonar-per-step."""
    crosstalk: float = 0.0
    """Probability with which a sonar hears the pulses of neighbours that fire together with it."""
    dropout: float = 0.0
    """Probability with which a sonar hears no echo and reads its maximum."""
    infrared_by_colour: bool = False
    """Dark obstacles seem farther to infrared sensors, or are not seen at all."""
    sticky_bumpers: float = 0.0
    """Bumpers read pressed for so many seconds after the last touch."""
    heading_drift: float = 0.0
    """The heading by odometry turns by so many degrees with each metre driven."""
    gyroscope: bool = False
    """A gyroscope corrects the heading by odometry."""

    @contextmanager
    def path_finding(self) -> Generator[PathFinding, None, None]:
        """Load the path-finding environment and close it in the end."""
        env = nomad_mj.load("path_finding", **self.load_options())
        try:
            yield env
        finally:
            env.close()

    def load_options(self) -> dict[str, Any]:
        """Return the arguments of `nomad_mj.load`, and of Gymnasium's environments."""
        return {
            "room": self.room,
            "robot": self.robot,
            "task_kwargs": self._task_kwargs(),
            "goal": self._goal_place(),
        }

    def _task_kwargs(self) -> dict[str, Any]:
        moving: dict[str, Any] = {"moving_goal": MovingGoal()} if self.moving_goal else {}
        if self.moving_obstacles:
            moving["moving_obstacles"] = MovingObstacles(count=self.moving_obstacles)
        return {**moving, **self._sensor_kwargs()}

    def _sensor_kwargs(self) -> dict[str, Any]:
        """Return how the sensors err."""
        if not 0 < self.grazing <= _EVERY_ECHO:
            raise ConfigError(f"grazing {self.grazing:g}: must be above 0 and at most 90 degrees")
        angle = math.radians(self.grazing) if self.grazing < _EVERY_ECHO else None
        drift = math.radians(self.heading_drift)
        return {
            "range_noise": RangeNoise(
                "gaussian" if self.gaussian_noise else "uniform", self.range_noise, grazing=angle
            ),
            "odometry_noise": OdometryNoise(position=self.odometry_error, heading_per_metre=drift),
            "sonar": SonarEffects(
                firing=self._firing(),
                crosstalk=Crosstalk(self.crosstalk) if self.crosstalk else None,
                dropout=self.dropout,
            ),
            "infrared": InfraredEffects() if self.infrared_by_colour else None,
            "bumper_noise": BumperNoise(hold=self.sticky_bumpers),
            "gyroscope": Gyroscope() if self.gyroscope else None,
        }

    def _firing(self) -> FiringOrder | None:
        if self.sonar_per_step:
            return FiringOrder(
                self.sonar_per_step, "spread" if self.spread_firing else "sequential"
            )
        if self.spread_firing:
            raise ConfigError("spread firing: needs --sonar-per-step, how many fire together")
        return None

    def _goal_place(self) -> tuple[float, float] | None:
        """Return where `--goal` is [m], None for the room's own."""
        return parse_place("goal", self.goal)

    def conditions(self) -> dict[str, Any]:
        """Return under which conditions the robot drives, as plain data: all but room and robot."""
        place = self._goal_place()
        named = {each.name: getattr(self, each.name) for each in fields(TaskOptions)}
        named["goal"] = "" if place is None else "{:g},{:g}".format(*place)
        return {name: value for name, value in named.items() if name not in ("room", "robot")}

    def require_same(self, conditions: Mapping[str, Any], path: str) -> None:
        """Raise CheckpointError unless a training under `conditions` can go on under these.

        Parameters
        ----------
        conditions : mapping
            As of `conditions`; what is not in it was as it is by default.
        path : str
            Of the checkpoint, for the message.
        """
        usual = TaskOptions().conditions()
        for name, mine in self.conditions().items():
            theirs = conditions.get(name, usual[name])
            if theirs != mine:
                option = f"--{name.replace('_', '-')}"
                raise CheckpointError(
                    f"cannot resume {path!r}: it was trained with {option} {theirs!r}, not {mine!r}"
                )


def parse_place(what: str, text: str) -> tuple[float, float] | None:
    """Return the place that ``X,Y`` names [m], None for no text.

    Raises
    ------
    ConfigError
        Anything but two finite numbers.
    """
    if not text:
        return None
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        raise ConfigError(f"{what} {text!r}: must be X,Y in metres, such as 8,2.5") from None
    return x, y
