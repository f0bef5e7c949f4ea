"""Episodes as a dataset for offline learning, in the format of Minari."""

import os
import re
import shutil
import tempfile
import warnings
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import gymnasium
import numpy as np

from nomad_agents.agent import Agent
from nomad_agents.extras import need
from nomad_mj.envs import PathFinding, percept_of
from nomad_mj.errors import ConfigError, OutputError
from nomad_mj.gym import NavigationEnv
from nomad_mj.gym.registration import PATH_FINDING

ROOT = "MINARI_DATASETS_PATH"  # the variable that tells Minari where datasets are
_ID = re.compile(r"(?:[-\w]+/)*[-\w]*?-v\d+")
_WHAT = "a dataset"


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


def require_new(root: Path, dataset_id: str) -> None:
    """Check that a dataset can be written before anything is driven.

    Raises
    ------
    ConfigError
        An id that Minari would not take.
    OutputError
        There is such a dataset.
    """
    if not _ID.fullmatch(dataset_id):
        raise ConfigError(
            f"dataset {dataset_id!r}: must be NAME-v0 or FOLDER/NAME-v0, of letters, digits, _, -"
        )
    if (root / dataset_id).exists():
        raise OutputError(f"dataset {dataset_id!r} exists in {str(root)!r}; choose another version")


def datasets_root(folder: str) -> Path:
    """Return where datasets are: that folder, or where Minari looks if it is empty."""
    usual = os.environ.get(ROOT) or Path("~", ".minari", "datasets")
    try:
        return Path(folder or usual).expanduser().absolute()
    except RuntimeError as error:  # a home that there is not
        raise OutputError(f"cannot write datasets: {error}") from None


def write_dataset(
    root: Path,
    dataset_id: str,
    env: "gymnasium.Env[Any, Any]",
    episodes: Sequence[Recorded],
    *,
    agent: str,
    description: str,
) -> Path:
    """Write episodes as a dataset, whole or not at all; return its folder.

    Parameters
    ----------
    root : Path
        The folder of all datasets.
    dataset_id : str
        Name of this one, such as ``"nomad_mj/paper_room-planner-v0"``.
    env : gymnasium.Env
        Where the episodes come from; the dataset tells how to make it again.
    episodes : sequence of Recorded
        At least one.
    agent, description : str
        Who drove, and what else there is to say.

    Raises
    ------
    ConfigError
        No episode has a step, or Minari is not installed.
    OutputError
        There is such a dataset, or the folder cannot be written.
    """
    need("minari", "minari", _WHAT)
    require_new(root, dataset_id)
    final = root / dataset_id
    if not episodes:
        raise ConfigError(f"dataset {dataset_id!r}: no episode has a single step")
    try:
        root.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=root, prefix=".export-") as temporary:
            with _root(Path(temporary)):
                _create(dataset_id, env, episodes, agent, description)
            _add_namespaces(root, Path(temporary), final.parent)
            shutil.move(Path(temporary) / dataset_id, final)
    except OSError as error:
        reason = error.strerror or str(error)
        raise OutputError(f"cannot write dataset {str(final)!r}: {reason}") from None
    return final


@contextmanager
def _root(path: Path) -> Generator[None, None, None]:
    """Let Minari look for datasets there."""
    before = os.environ.get(ROOT)
    os.environ[ROOT] = str(path)
    try:
        yield
    finally:
        if before is None:
            del os.environ[ROOT]
        else:
            os.environ[ROOT] = before


def _create(
    dataset_id: str,
    env: "gymnasium.Env[Any, Any]",
    episodes: Sequence[Recorded],
    agent: str,
    description: str,
) -> None:
    minari = need("minari", "minari", _WHAT)
    buffer = need("minari.data_collector.episode_buffer", "minari", _WHAT).EpisodeBuffer
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # it misses an author and a link
        minari.create_dataset_from_buffers(
            dataset_id,
            [_buffer(buffer, number, episode) for number, episode in enumerate(episodes)],
            env=env,
            algorithm_name=agent,
            description=description,
            requirements=[f"nomad-mj=={version('nomad-mj')}"],
        )


def _buffer(buffer: Any, number: int, episode: Recorded) -> Any:
    """Return Minari's form of an episode."""
    running = [False] * (len(episode.actions) - 1)
    return buffer(
        id=number,
        seed=episode.seed,
        options={"start": episode.start},
        observations=_columns(episode.observations),
        actions=episode.actions,
        rewards=episode.rewards,
        terminations=[*running, episode.terminated],
        truncations=[*running, episode.truncated],
        infos=_columns(episode.infos),
    )


def _columns(rows: list[Any]) -> Any:
    """Turn a list of dictionaries into a dictionary of lists; leave other lists alone."""
    if not isinstance(rows[0], dict):
        return rows
    return {name: [row[name] for row in rows] for name in rows[0]}


def _add_namespaces(root: Path, temporary: Path, parent: Path) -> None:
    """Make the folders of a dataset's id, with the files that make them known to Minari."""
    parent.mkdir(parents=True, exist_ok=True)
    for file in temporary.rglob("namespace_metadata.json"):
        place = root / file.relative_to(temporary)
        if not place.exists():
            shutil.move(file, place)
