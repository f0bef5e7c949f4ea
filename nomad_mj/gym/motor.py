"""``nomad_mj/Motor-v0``: one step is one control step of the motors, at 20 Hz."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from nomad_mj.envs import DEFAULT_ROBOT, DEFAULT_ROOM, load
from nomad_mj.gym.account import MotorMeasures
from nomad_mj.gym.base import NavigationEnv, picture_size, refuse_observation
from nomad_mj.gym.camera import Camera
from nomad_mj.gym.everything import EverythingObserver
from nomad_mj.gym.observations import DrivenRangesObserver, Observer
from nomad_mj.gym.options import task_options
from nomad_mj.gym.reward import RewardOptions
from nomad_mj.types import FloatArray


class MotorEnv(NavigationEnv):
    """Reach the goal with motor velocities as actions; see `nomad_mj.tasks.MotorTask`.

    Actions are the motors' commands as a share of their largest, in [-1, 1] and in the order of
    the robot's drive. The episode terminates at the goal, unless ``ends_at_goal`` of `task_kwargs`
    is false, and is truncated at the time limit.

    Parameters
    ----------
    room, robot, task_kwargs, goal, reward, goal_bonus, progress, render_mode, view, width, height
        As of `PathFindingEnv`.
    observation : "ranges" or "dict"
        What is observed; see `observations.DrivenRangesObserver` and `everything`.
    time_limit : float
        Length of an episode [s of simulated time]; that of `gymnasium.make` is 2400 steps, 120 s.

    Raises
    ------
    NomadError
        Anything wrong with these, in one line.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 20}  # noqa: RUF012

    def __init__(
        self,
        room: str | Path = DEFAULT_ROOM,
        robot: str | Path = DEFAULT_ROBOT,
        observation: Literal["ranges", "dict"] = "ranges",
        *,
        task_kwargs: Mapping[str, Any] | None = None,
        goal: Sequence[float] | None = None,
        time_limit: float = math.inf,
        reward: Literal["task", "sparse"] = "task",
        goal_bonus: float = 0.0,
        progress: float = 0.0,
        render_mode: str | None = None,
        view: str = "overview",
        width: int | None = None,
        height: int | None = None,
    ) -> None:
        options = RewardOptions(reward, goal_bonus, progress)
        refuse_observation(observation, ("ranges", "dict"))
        env = load(
            "motor", room, robot, task_options(task_kwargs), {"time_limit": time_limit}, goal=goal
        )
        try:
            scene = env.task.scene
            camera = Camera(scene, view, picture_size(width, height))
            observers: dict[str, Observer] = {
                "ranges": DrivenRangesObserver(scene, env.task),
                "dict": EverythingObserver(scene, env.observation_spec()),
            }
            spec = env.action_spec()
            self._low, self._high = spec.minimum, spec.maximum
            count = spec.shape[0]
            measures = MotorMeasures(env.task, env.physics)
            super().__init__(
                env, observers[observation], options, measures, count, render_mode, camera
            )
        except BaseException:
            env.close()
            raise

    def _command(self, action: FloatArray) -> FloatArray:
        """Return the motors' commands; 0 is 0, whatever the limits."""
        return motor_commands(action, self._low, self._high)


def motor_commands(actions: FloatArray, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return the commands (..., M) of actions in [-1, 1], given the motors' limits; 0 is 0."""
    return (actions * np.maximum(np.abs(low), np.abs(high))).clip(low, high)
