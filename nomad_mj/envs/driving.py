"""A move under way: what a control step takes and gives, for one robot or many side by side."""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from nomad_mj.motion import ActionSpec, MotionConfig, Outcome, displacement, reinforcement
from nomad_mj.robots import RobotDescription
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.types import FloatArray, SensorLayout, Travel

_TURN = 2 * math.pi


class Move(NamedTuple):
    """What became of a move: distances in metres, `ticks` control steps.

    `contact`: whether something was truly touched, in whatever part of the move.
    """

    outcome: Outcome
    clearance: float
    driven: float = 0.0
    ticks: int = 0
    contact: bool = False


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
        What counts as ahead. Its security distance is raised to what the sensors can tell,
        wherever they look.
    """

    def __init__(self, layout: SensorLayout, config: MotionConfig) -> None:
        # They read no less than their minimum.
        distances = np.maximum(config.security_distance, 1.1 * layout.least_readings)
        self.motion = replace(config, security_distance=float(distances.min()))
        bearings = np.concatenate([ring.bearings for ring in layout.rings])
        self._edges, table = _slacks(
            bearings, config.ahead, max(config.ahead, math.pi / 2), self.motion.beside
        )
        self._table = table - (distances - distances.min())
        self._bounds: list[float] = self._edges.tolist()  # for one robot alone

    def slack(self, heading: float, sensors: float) -> FloatArray:
        """Return how much nearer things may be before each sensor, (C,) [m]; infinite: behind.

        Beside the robot, beyond `ahead`, that is `beside`: corners pass there between two sensors.
        It is negative for sensors that cannot tell what is as near as others can elsewhere.

        Parameters
        ----------
        heading : float
            Where the robot drives [rad].
        sensors : float
            Direction of the frame of its range sensors [rad].
        """
        return self._table[bisect_right(self._bounds, (sensors - heading) % _TURN)]

    def slacks(self, heading: FloatArray, sensors: FloatArray) -> FloatArray:
        """Return the same for many robots, (n, C) [m], given (n,) and (n,)."""
        turned = np.mod(sensors - heading, _TURN)
        return self._table[np.searchsorted(self._edges, turned, side="right")]


def _slacks(
    bearings: FloatArray, ahead: float, aside: float, beside: float
) -> tuple[FloatArray, FloatArray]:
    """Return between which directions of the sensors' frame slacks are the same, and which.

    They change only where a sensor comes within `ahead` or `aside` of the way [rad].

    Returns
    -------
    edges : array (K,)
        Where they change, ascending in [0, 2 pi), against the way [rad].
    table : array (K + 1, C)
        Below the first of them, between each and the next, from the last on [m].
    """
    limits = np.minimum(np.array([ahead, aside]) + 1e-9, math.pi)
    edges = np.unique(np.mod(np.concatenate([limits, -limits])[:, None] - bearings, _TURN))
    bounds = np.array([0.0, *edges, _TURN])
    middles = (bounds[1:] + bounds[:-1]) / 2
    along = np.cos(bearings + middles[:, None])
    near, far = np.cos(limits)
    slack = np.where(along >= near, 0.0, np.where(along >= far, beside, np.inf))
    return edges, slack


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
    odometry : sequence of float, length 4
        As observed.
    bumped, touched : int
        How many bumpers report a touch already; how many are truly touched.
    """

    def __init__(
        self,
        move: FloatArray,
        robot: RobotDescription,
        motion: MotionConfig,
        odometry: Sequence[float],
        bumped: int,
        touched: int,
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
        self._bumped, self._touched = bumped, touched
        self._new_bump = self._contact = False
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
        command = self._move.command(self._travel, free, self._new_bump)
        return None if self._move.done else command

    def take_in(
        self,
        travel: Travel,
        odometry: Sequence[float],
        nearest: float,
        bumped: int,
        touched: int,
    ) -> None:
        """Take in a control step: its way, the odometry, the shortest reading [m], contacts.

        `bumped` is how many bumpers report a touch, which the move heeds if there are more of
        them; `touched` how many are truly touched, which counts.
        """
        self._travel = travel = _facing(travel, odometry)
        # What was touched before the move, and still is, is no contact of this move.
        self._contact |= touched > self._touched
        self._new_bump = bumped > self._bumped
        self._bumped, self._touched = bumped, touched
        self._clearance = min(self._clearance, nearest)
        self._driven += math.hypot(travel.forward, travel.sideways)
        self._ticks += 1

    def result(self) -> Move:
        """Return what became of the move."""
        return Move(self._move.outcome, self._clearance, self._driven, self._ticks, self._contact)


def _facing(travel: Travel, odometry: Sequence[float]) -> Travel:
    """Return a way with the directions that odometry tells."""
    _, _, heading, sensors = odometry
    return Travel(travel.forward, travel.sideways, heading, sensors)
