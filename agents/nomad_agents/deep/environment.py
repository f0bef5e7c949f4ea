"""Where deep learners learn: Gymnasium's path finding, with what the settings say of it."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import gymnasium

from nomad_agents.deep.settings import DeepSettings
from nomad_mj.envs import DEFAULT_ROBOT, DEFAULT_ROOM
from nomad_mj.errors import ConfigError
from nomad_mj.gym import PathFindingEnv
from nomad_mj.gym.registration import PATH_FINDING
from nomad_mj.perception import OBSERVATIONS


def make_env(
    settings: DeepSettings,
    observation: str = "situation",
    room: str | Path = DEFAULT_ROOM,
    robot: str | Path = DEFAULT_ROBOT,
    task_kwargs: Mapping[str, Any] | None = None,
    goal: Sequence[float] | None = None,
) -> "gymnasium.Env[Any, Any]":
    """Return `nomad_mj/PathFinding-v0` to learn in; whoever asked for it closes it.

    Parameters
    ----------
    settings : SacSettings, Td3Settings or PpoSettings
        Its bonus at the goal, and after how many decisions an episode is given up.
    observation : "situation" or "ranges"
        What the network is shown.
    room, robot, task_kwargs, goal
        As of `nomad_mj.load`.

    Raises
    ------
    NomadError
        Anything wrong with these, in one line.
    """
    if observation not in OBSERVATIONS:
        raise ConfigError(f"observation {observation!r}: must be one of: {', '.join(OBSERVATIONS)}")
    return gymnasium.make(
        PATH_FINDING,
        max_episode_steps=settings.episode_decisions,
        disable_env_checker=True,
        room=room,
        robot=robot,
        observation=observation,
        task_kwargs=task_kwargs,
        goal=goal,
        goal_bonus=settings.goal_bonus,
    )


def task_of(env: "gymnasium.Env[Any, Any]") -> PathFindingEnv:
    """Return the environment of this package in its wrappers; ConfigError if it is another."""
    task = env.unwrapped
    if not isinstance(task, PathFindingEnv) or task.observation not in OBSERVATIONS:
        raise ConfigError(
            f"environment {env.spec.id if env.spec else task}: deep learners of this package learn "
            f"in {PATH_FINDING!r} with observation {' or '.join(OBSERVATIONS)}"
        )
    return task
