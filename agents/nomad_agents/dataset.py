"""Episodes as a dataset for offline learning, in the format of Minari."""

import os
import re
import shutil
import tempfile
import warnings
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from pathlib import Path
from typing import Any

import gymnasium

from nomad_agents.collecting import Recorded
from nomad_agents.extras import need
from nomad_mj.errors import ConfigError, OutputError

ROOT = "MINARI_DATASETS_PATH"  # the variable that tells Minari where datasets are
_ID = re.compile(r"(?:\w[-\w]+/)*\w[-\w]*?-v\d+")
_WHAT = "a dataset"


def require_new(root: Path, dataset_id: str) -> None:
    """Check that a dataset can be written before anything is driven.

    Raises
    ------
    ConfigError
        An id that Minari would not take.
    OutputError
        There is such a dataset, or none can be written there.
    """
    if not _ID.fullmatch(dataset_id):
        raise ConfigError(
            f"dataset {dataset_id!r}: must be NAME-v0 or FOLDER/NAME-v0, of letters, digits, _, -"
        )
    try:
        there = (root / dataset_id).exists()
        root.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=root):
            pass
    except OSError as error:
        raise OutputError(f"cannot write datasets to {str(root)!r}: {error.strerror}") from None
    if there:
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
