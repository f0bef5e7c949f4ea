"""The account of an episode: what is observed, what is paid, what it cost, and the truth."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import dm_env
import numpy as np

from nomad_mj.gym.observations import Observer
from nomad_mj.gym.reward import RewardOptions
from nomad_mj.motion import Outcome
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.tasks import MotorTask
from nomad_mj.types import FloatArray, Pose

Measures = Callable[[dm_env.TimeStep], dict[str, Any]]
_SUMMED = ("cost", "driven", "duration")


class Body(Protocol):
    """What is asked of a simulation: that of one robot, or one of many."""

    def pose(self) -> Pose:
        """Return the true pose."""
        ...

    def bumpers(self) -> FloatArray:
        """Return 1 for each bumper touched since the last control step, else 0, (B,)."""
        ...


class Account:
    """Keeps the account of one robot, episode after episode.

    Parameters
    ----------
    task : MotorTask
        Knows goal and readings.
    body : Body
        The simulation of its robot.
    observer : Observer
        Makes the observations; it may remember, so each account needs its own.
    reward : RewardOptions
        What the reward is made of.
    measures : callable
        What a step tells of itself; at least cost, driven and duration.
    """

    def __init__(
        self,
        task: MotorTask,
        body: Body,
        observer: Observer,
        reward: RewardOptions,
        measures: Measures,
    ) -> None:
        self._task, self._body = task, body
        self._observer, self._reward, self._measures = observer, reward, measures
        self._distance = 0.0
        self.totals: dict[str, float] = dict.fromkeys(_SUMMED, 0.0)

    def begin(self, step: dm_env.TimeStep) -> tuple[Any, dict[str, Any]]:
        """Take in the first time step of an episode; return observation and info."""
        self.totals = dict.fromkeys(_SUMMED, 0.0)
        self._distance = self._task.goal_distance(self._body)
        return self._observer(step.observation, True), self._info(step)

    def go_on(self, step: dm_env.TimeStep) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Take in a time step; return observation, reward, terminated, truncated, info."""
        before, self._distance = self._distance, self._task.goal_distance(self._body)
        info = self._info(step)
        # dm_control looks at the clock before it looks at the goal.
        at_goal = step.discount == 0.0 or self._task.ends_at(self._distance)
        terminated = step.last() and at_goal
        reward = self._reward.total(float(step.reward), info["is_success"], before - self._distance)
        observed = self._observer(step.observation, False)
        return observed, reward, terminated, step.last() and not terminated, info

    def _info(self, step: dm_env.TimeStep) -> dict[str, Any]:
        """Return measures, costs and the truth, the same keys in every step."""
        measures = self._measures(step)
        for name in _SUMMED:
            self.totals[name] += measures[name]
        return {
            **measures,
            "goal_distance": self._distance,
            "pose": np.array(self._body.pose()),
            "is_success": bool(self._distance <= self._task.config.goal_radius),
            **{f"total_{name}": value for name, value in self.totals.items()},
        }


@dataclass(frozen=True)
class MotorMeasures:
    """What measures a control step of the motor task.

    Not a function within a function: a copy of an environment measures itself.
    """

    task: MotorTask
    body: Body

    def __call__(self, step: dm_env.TimeStep) -> dict[str, Any]:
        """Return the measures of a time step."""
        travel = self.task.travel
        bumped = bool(np.count_nonzero(self.body.bumpers()))
        driven = 0.0 if step.first() else math.hypot(travel.forward, travel.sideways)
        return {
            "cost": float(bumped),
            "bumper_contact": bumped,
            "clearance": float(self.task.ranges.min()),
            "duration": 0.0 if step.first() else CONTROL_TIMESTEP,
            "driven": driven,
        }


class MoveMeasures:
    """What measures a move of path finding."""

    def __init__(self, task: MotorTask) -> None:
        self._farthest = max(ring.max_range for ring in task.scene.robot.layout.rings)

    def __call__(self, step: dm_env.TimeStep) -> dict[str, Any]:
        """Return the measures of a time step."""
        seen = step.observation
        outcome = Outcome(int(seen["outcome"]))
        stopped, bumped = outcome is Outcome.VIRTUAL_COLLISION, bool(seen["contact"])
        return {
            "cost": float(stopped or bumped),
            "virtual_collision": stopped,
            "bumper_contact": bumped,
            # Infinite after a move that has not begun.
            "clearance": float(np.minimum(seen["clearance"], self._farthest)),
            "duration": float(seen["duration"]),
            "driven": float(seen["driven"]),
            "outcome": int(outcome),
        }
