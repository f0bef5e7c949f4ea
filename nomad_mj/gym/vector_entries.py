"""What `gymnasium.make_vec` makes: the vector environments of both tasks."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode

from nomad_mj.batch import BatchMotor, BatchPathFinding, load_batch
from nomad_mj.batch.load import Goals, Rooms
from nomad_mj.envs import DEFAULT_ROBOT, DEFAULT_ROOM
from nomad_mj.errors import ConfigError
from nomad_mj.gym.account import Account, Measures, MotorMeasures, MoveMeasures
from nomad_mj.gym.base import refuse_observation
from nomad_mj.gym.everything import EverythingObserver
from nomad_mj.gym.motor import motor_commands
from nomad_mj.gym.observations import (
    DrivenRangesObserver,
    Observer,
    RangesObserver,
    SituationObserver,
)
from nomad_mj.gym.options import structure, task_options
from nomad_mj.gym.reward import RewardOptions
from nomad_mj.gym.vector import NavigationVectorEnv
from nomad_mj.perception import SituationSpec
from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray


def path_finding_vector_env(
    num_envs: int = 1,
    room: Rooms = DEFAULT_ROOM,
    robot: str = DEFAULT_ROBOT,
    observation: Literal["situation", "ranges", "dict"] = "situation",
    *,
    task_kwargs: Mapping[str, Any] | None = None,
    goal: Goals = None,
    time_limit: float = 300.0,
    situation: SituationSpec | Mapping[str, Any] | None = None,
    reward: Literal["task", "sparse"] = "task",
    goal_bonus: float = 0.0,
    progress: float = 0.0,
    threads: int | None = None,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    max_episode_steps: int | None = None,
    render_mode: str | None = None,
) -> NavigationVectorEnv:
    """Return many `PathFindingEnv` in one.

    Parameters
    ----------
    num_envs : int
        How many.
    room, goal, threads
        As of `nomad_mj.load_batch`: one room for all or several, likewise the goal.
    robot, observation, task_kwargs, time_limit, situation, reward, goal_bonus, progress
        As of `PathFindingEnv`.
    autoreset_mode, max_episode_steps
        As of `NavigationVectorEnv`.
    render_mode : None
        There are no pictures of many; the single environment draws.

    Raises
    ------
    NomadError
        Anything wrong with these, in one line.
    """
    _refuse_pictures(render_mode)
    options = RewardOptions(reward, goal_bonus, progress)
    spec = structure("situation", situation or SituationSpec(), SituationSpec)
    refuse_observation(observation, ("situation", "ranges", "dict"))
    limits = {"time_limit": time_limit}
    given = task_options(task_kwargs)
    batch = load_batch(
        "path_finding", num_envs, room, robot, given, limits, goal=goal, threads=threads
    )
    observers = [_move_observer(observation, scene, spec, batch) for scene in batch.scenes]
    measures = [MoveMeasures(task) for task in batch.tasks]
    accounts = _accounts(batch, observers, options, measures)
    space = spaces.Box(-1.0, 1.0, (2,), np.float32)
    seen = _common([observer.space for observer in observers])
    return NavigationVectorEnv(batch, accounts, seen, space, autoreset_mode, max_episode_steps)


def _move_observer(
    observation: str, scene: Scene, situation: SituationSpec, batch: BatchPathFinding
) -> Observer:
    if observation == "situation":
        return SituationObserver(scene, situation)
    if observation == "ranges":
        return RangesObserver(scene)
    return EverythingObserver(scene, batch.single_observation_spec())


def motor_vector_env(
    num_envs: int = 1,
    room: Rooms = DEFAULT_ROOM,
    robot: str = DEFAULT_ROBOT,
    observation: Literal["ranges", "dict"] = "ranges",
    *,
    task_kwargs: Mapping[str, Any] | None = None,
    goal: Goals = None,
    time_limit: float = math.inf,
    reward: Literal["task", "sparse"] = "task",
    goal_bonus: float = 0.0,
    progress: float = 0.0,
    threads: int | None = None,
    autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
    max_episode_steps: int | None = None,
    render_mode: str | None = None,
) -> NavigationVectorEnv:
    """Return many `MotorEnv` in one; parameters and errors as of `path_finding_vector_env`."""
    _refuse_pictures(render_mode)
    options = RewardOptions(reward, goal_bonus, progress)
    refuse_observation(observation, ("ranges", "dict"))
    limits = {"time_limit": time_limit}
    given = task_options(task_kwargs)
    batch = load_batch("motor", num_envs, room, robot, given, limits, goal=goal, threads=threads)
    observers: list[Observer] = [
        DrivenRangesObserver(task.scene, task)
        if observation == "ranges"
        else EverythingObserver(task.scene, batch.single_observation_spec())
        for task in batch.tasks
    ]
    pairs = zip(batch.tasks, batch.worlds.worlds, strict=True)
    accounts = _accounts(batch, observers, options, [MotorMeasures(*pair) for pair in pairs])
    space = spaces.Box(-1.0, 1.0, batch.action_spec().shape[1:], np.float32)
    seen = _common([observer.space for observer in observers])
    return _MotorVectorEnv(batch, accounts, seen, space, autoreset_mode, max_episode_steps)


class _MotorVectorEnv(NavigationVectorEnv):
    batch: BatchMotor

    def _commands(self, actions: FloatArray) -> FloatArray:
        spec = self.batch.action_spec()
        return motor_commands(actions, spec.minimum, spec.maximum)


def _accounts(
    batch: BatchPathFinding | BatchMotor,
    observers: Sequence[Observer],
    reward: RewardOptions,
    measures: Sequence[Measures],
) -> list[Account]:
    """Return an account for each world, given its observer and what measures its steps."""
    parts = zip(batch.tasks, batch.worlds.worlds, observers, measures, strict=True)
    return [
        Account(task, world, observer, reward, measure) for task, world, observer, measure in parts
    ]


def _refuse_pictures(render_mode: str | None) -> None:
    if render_mode is not None:
        raise ConfigError(
            f"render mode {render_mode!r}: many at once are not drawn; use gymnasium.make, or "
            "make_vec with vectorization_mode='sync'"
        )


def _common(seen: "list[spaces.Space[Any]]") -> "spaces.Space[Any]":
    """Return a space that holds the observations of all: rooms differ in size."""
    first = seen[0]
    if isinstance(first, spaces.Dict):
        parts = [space for space in seen if isinstance(space, spaces.Dict)]
        return spaces.Dict({name: _common([part[name] for part in parts]) for name in first})
    if not isinstance(first, spaces.Box):
        return first
    boxes = [space for space in seen if isinstance(space, spaces.Box)]
    low = np.minimum.reduce([box.low for box in boxes])
    high = np.maximum.reduce([box.high for box in boxes])
    return spaces.Box(low, high, dtype=first.dtype.type)
