"""Let an agent drive in a Gymnasium environment and keep all that happens."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import gymnasium
import numpy as np

from nomad_agents.agent import Agent
from nomad_mj.envs import PathFinding, percept_of
from nomad_mj.errors import ConfigError
from nomad_mj.gym import NavigationEnv
from nomad_mj.gym.registration import PATH_FINDING


class Recorded(NamedTuple):
    """One episode: T steps, T + 1 observations and infos.

    Attributes
    ----------
    seed : int
        With which the environment was reset.
    start : list of float
        Where it started: x, y [m], heading [rad].
    observations, actions, rewards, infos : list
        As the environment gave and took them.
    terminated, truncated : bool
        How it ended; given up, it counts as truncated.
    """

    seed: int
    start: list[float]
    observations: list[Any]
    actions: list[Any]
    rewards: list[float]
    infos: list[dict[str, Any]]
    terminated: bool
    truncated: bool


def collect(
    env: "gymnasium.Env[Any, Any]",
    agent: Agent,
    starts: Sequence[Sequence[float]],
    seed: int,
    after_episode: Callable[[Recorded], None] | None = None,
) -> list[Recorded]:
    """Let an agent drive one episode from each start, greedily.

    Parameters
    ----------
    env : gymnasium.Env
        `PathFindingEnv`, wrapped or not; a time limit among the wrappers ends episodes.
    agent : Agent
        Of the same robot. It perceives by itself, whatever the environment's observations are.
    starts : sequence of (x, y, heading)
        Where the episodes start [m], [rad].
    seed : int
        From which the episodes' seeds are drawn.
    after_episode : callable, optional
        Called after each episode.
    """
    streams = np.random.SeedSequence(seed).spawn(len(starts))
    episodes = list[Recorded]()
    for stream, start in zip(streams, starts, strict=True):
        # 32 bits, which every tool that stores the seed of an episode can hold.
        episodes.append(_drive(env, agent, int(stream.generate_state(1)[0]), list(start)))
        if after_episode is not None:
            after_episode(episodes[-1])
    return [episode for episode in episodes if episode.actions]


def _drive(env: "gymnasium.Env[Any, Any]", agent: Agent, seed: int, start: list[float]) -> Recorded:
    task, seen = task_of(env).motor.task, env.get_wrapper_attr
    observation, info = env.reset(seed=seed, options={"start": start})
    observations, infos = [observation], [info]
    actions, rewards = list[Any](), list[float]()
    agent.start_episode(task.random)
    terminated = truncated = False
    while not (terminated or truncated):
        percept = percept_of(seen("seen"), agent.layout, agent.situation)
        decision = agent.act(percept, None)
        if decision.kind == "none":
            truncated = True  # the agent does not know how to act
            break
        action = np.clip(decision.action, -1.0, 1.0).astype(np.float32)
        observation, reward, terminated, truncated, info = env.step(action)
        actions.append(action)
        observations.append(observation)
        rewards.append(float(reward))
        infos.append(info)
    return Recorded(seed, start, observations, actions, rewards, infos, terminated, truncated)


def task_of(env: "gymnasium.Env[Any, Any]") -> PathFinding:
    """Return what lies below a Gymnasium environment of this package, for agents of it."""
    made = env.unwrapped
    if not isinstance(made, NavigationEnv) or not isinstance(made.environment, PathFinding):
        raise ConfigError(f"environment {env}: agents of this package drive in {PATH_FINDING!r}")
    return made.environment
