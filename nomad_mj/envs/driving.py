"""A move under way: what a control step takes and gives, for one robot or many side by side."""

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from nomad_mj.motion import ActionSpec, MotionConfig, Outcome, displacement, reinforcement
from nomad_mj.robots import RobotDescription
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.types import FloatArray, SensorLayout, Travel


class Move(NamedTuple):
    """What became of a move: distances in metres, `ticks` control steps."""

    outcome: Outcome
    clearance: float
    driven: float = 0.0
    ticks: int = 0


def asked_move(action: Any, goal: FloatArray, spec: ActionSpec, name: str = "action") -> FloatArray:
    """Return the displacement (2,) [m] that an action asks for, clipped to [-1, 1].

    Raises
    ------
    ValueError
        It is not two finite numbers.
    """
    action = np.asarray(action, dtype=np.float64)
    if action.shape != (2,) or not np.isfinite(action).all():
        raise ValueError(f"{name} {action}: must be two finite numbers (dx, dy) in [-1, 1]")
    return displacement(np.clip(action, -1.0, 1.0), goal, spec)


def reward_of(done: Move, move: FloatArray, goal: FloatArray) -> float:
    """Return z for what became of a displacement (2,), `goal` (2,) being where it began [m]."""
    collided = done.outcome in (Outcome.VIRTUAL_COLLISION, Outcome.BUMPED)
    return float(reinforcement(move, goal, done.clearance, collided))


class Lookout:
    """Which range sensors look to where a robot drives, and how far it is free there.

    Parameters
    ----------
    layout : SensorLayout
        The robot's range sensors.
    config : MotionConfig
        What counts as ahead. Its security distance is raised to what the sensors can tell.
    """

    def __init__(self, layout: SensorLayout, config: MotionConfig) -> None:
        nearest = min(ring.min_range for ring in layout.rings)
        # They read no less than their minimum.
        self.motion = replace(
            config, security_distance=max(config.security_distance, 1.1 * nearest)
        )
        self._bearings = np.concatenate([ring.bearings for ring in layout.rings])
        self._ahead, self._beside = (
            math.cos(min(angle + 1e-9, math.pi))
            for angle in (config.ahead, max(config.ahead, math.pi / 2))
        )

    def slack(self, heading: FloatArray | float, sensors: FloatArray | float) -> FloatArray:
        """Return how much nearer things may be before each sensor, (..., C) [m]; infinite: behind.

        Beside the robot, beyond `ahead`, that is `beside`: corners pass there between two sensors.

        Parameters
        ----------
        heading : array (...)
            Where the robot drives [rad].
        sensors : array (...)
            Direction of the frame of its range sensors [rad].
        """
        # By their cosines, which need not be brought into a half-turn first.
        along = np.cos(self._bearings + np.asarray(sensors - heading)[..., None])
        beside = np.where(along >= self._beside, self.motion.beside, np.inf)
        return np.where(along >= self._ahead, 0.0, beside)


class Driving:
    """One move of a robot, from the decision until it stands still.

    Parameters
    ----------
    move : array (2,)
        Displacement [m], odometry's frame.
    robot : RobotDescription
        Which robot.
    motion : MotionConfig
        How carefully to move, as of a `Lookout`.
    odometry : array (4,)
        As observed.
    bumped : bool
        Whether a bumper is touched already.
    """

    def __init__(
        self,
        move: FloatArray,
        robot: RobotDescription,
        motion: MotionConfig,
        odometry: FloatArray,
        bumped: bool,
    ) -> None:
        x, y = move.tolist()
        self._travel = _facing(Travel(0.0, 0.0, 0.0, 0.0), odometry)
        self._move = robot.drive.move(
            float(np.arctan2(y, x)),
            float(np.hypot(x, y)),
            self._travel,
            motion,
            CONTROL_TIMESTEP,
        )
        self._bumped = bumped
        self._clearance = math.inf  # until the move is under way
        self._driven, self._ticks = 0.0, 0

    @property
    def watched(self) -> tuple[float, float]:
        """Where the robot drives and where the frame of its sensors points [rad]."""
        return self._move.motion_heading, self._travel.sensors

    def command(self, free: float) -> tuple[float, ...] | None:
        """Return the motors' commands for the next control step; None: the move is over.

        Parameters
        ----------
        free : float
            Shortest reading ahead, by the `Lookout` [m].
        """
        command = self._move.command(self._travel, free, self._bumped)
        return None if self._move.done else command

    def take_in(self, travel: Travel, odometry: FloatArray, nearest: float, bumped: bool) -> None:
        """Take in a control step: its way, the odometry, the shortest reading [m], contacts."""
        self._travel = travel = _facing(travel, odometry)
        self._bumped = bumped
        self._clearance = min(self._clearance, nearest)
        self._driven += math.hypot(travel.forward, travel.sideways)
        self._ticks += 1

    def result(self) -> Move:
        """Return what became of the move."""
        return Move(self._move.outcome, self._clearance, self._driven, self._ticks)


def _facing(travel: Travel, odometry: FloatArray) -> Travel:
    """Return a way with the directions that odometry tells."""
    _, _, heading, sensors = odometry.tolist()
    return Travel(travel.forward, travel.sideways, heading, sensors)
