"""Checkpoints: what an agent has learnt and how far its training is, in one ``.npz`` file.

No pickle: arrays, and one JSON text under ``metadata``.
"""

import json
import os
import tempfile
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import IO, Any, NamedTuple, TypeVar, cast

import cattrs
import numpy as np

from nomad_agents.reactive_planner import ReactivePlanner, ReactivePlannerConfig
from nomad_mj.errors import CheckpointError, OutputError
from nomad_mj.types import SensorLayout

FORMAT = "nomad_mj.checkpoint"
VERSION = 1
_T = TypeVar("_T")


class Checkpoint(NamedTuple):
    """What a checkpoint file holds.

    Attributes
    ----------
    agent : ReactivePlanner
        What was learnt.
    layout : SensorLayout
        The sensors it was learnt with.
    room, robot : str
        Their names.
    training : dict
        The state of `training.Training`, as data.
    conditions : dict
        Goal, movers and errors of the sensors, where they are told; see `task_options`.
    """

    agent: ReactivePlanner
    layout: SensorLayout
    room: str
    robot: str
    training: dict[str, Any]
    conditions: dict[str, Any]


def _umask() -> int:
    """Return the mask of new files' permissions, which can only be read by setting it."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask


_UMASK = _umask()  # once: other threads would make files under the wrong one


def write_atomically(path: Path, write: Callable[[IO[bytes]], object]) -> None:
    """Write a file whole or not at all.

    Raises
    ------
    OutputError
        The folder cannot be made or the file cannot be written; the old file, if any, is kept.
    """
    temporary = ""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        with os.fdopen(handle, "wb") as file:
            write(file)
            file.flush()
            os.fsync(file.fileno())  # or a power cut could leave the new name with no content
        Path(temporary).chmod(0o666 & ~_UMASK)
        Path(temporary).replace(path)
        temporary = ""
    except OSError as error:
        reason = error.strerror or str(error)
        raise OutputError(f"cannot write {str(path)!r}: {reason}") from None
    finally:
        if temporary:
            Path(temporary).unlink(missing_ok=True)


def save_checkpoint(
    path: Path,
    agent: ReactivePlanner,
    room: str,
    robot: str,
    training: dict[str, Any],
    conditions: Mapping[str, Any] | None = None,
) -> None:
    """Write a checkpoint, whole or not at all; errors as of `write_atomically`."""
    metadata = {
        "format": FORMAT,
        "version": VERSION,
        "agent": agent.name,
        "config": cattrs.unstructure(agent.config),
        "layout": cattrs.unstructure(agent.layout),
        "room": room,
        "robot": robot,
        "training": training,
        "conditions": dict(conditions or {}),
        "packages": packages(),
    }
    write_npz(path, metadata, agent.network.arrays())


def packages(*more: str) -> dict[str, str]:
    """Return the versions of what a file is written with, and of `more` packages."""
    return {name: version(name) for name in ("nomad-mj", "mujoco", "numpy", *more)}


def write_npz(path: Path, metadata: Mapping[str, Any], arrays: Mapping[str, Any]) -> None:
    """Write arrays, and metadata as JSON beside them; errors as of `write_atomically`."""
    named: dict[str, Any] = {"metadata": np.array(json.dumps(metadata)), **arrays}
    write_atomically(path, lambda file: np.savez(file, **named))


def read_npz(path: Path) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the metadata and the arrays of a file of an agent, of whatever kind.

    Raises
    ------
    CheckpointError
        The file is missing or corrupt, or has no metadata.
    """
    try:
        # Opened here, since numpy leaves a file open that is no zip inside.
        with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
            arrays: dict[str, np.ndarray] = {name: file[name] for name in file.files}
        metadata: Any = json.loads(str(arrays.pop("metadata")[()]), parse_constant=_no_number)
    except FileNotFoundError:
        raise CheckpointError(f"checkpoint {str(path)!r} does not exist") from None
    except OSError as error:
        raise CheckpointError(
            f"checkpoint {str(path)!r} cannot be read: {error.strerror or error}"
        ) from None
    except Exception as error:  # nobody lists what zip, npy and JSON raise at damaged bytes
        raise corrupt(path, str(error) or type(error).__name__) from None
    if not isinstance(metadata, dict):
        raise CheckpointError(f"{str(path)!r} is no checkpoint")
    return cast(dict[str, Any], metadata), arrays


def _no_number(word: str) -> None:
    """Refuse what JSON does not know, though Python's reader takes it: NaN and infinities."""
    raise ValueError(f"{word} is no number")


def require_format(path: Path, metadata: Mapping[str, Any], format_id: str, number: int) -> None:
    """Raise CheckpointError unless a file is of this format and version."""
    if metadata.get("format") != format_id:
        raise CheckpointError(f"{str(path)!r} is no checkpoint of {format_id!r}")
    if metadata.get("version") != number:
        raise CheckpointError(
            f"checkpoint {str(path)!r} is of version {metadata.get('version')}; this program reads "
            f"version {number}: train again, or use the nomad-mj that wrote it"
        )


def load_checkpoint(path: Path) -> Checkpoint:
    """Return what a checkpoint file of the reactive planner holds.

    Raises
    ------
    CheckpointError
        The file is missing, corrupt, no checkpoint, or of an unknown version.
    """
    metadata, arrays = read_npz(path)
    return checkpoint_of(path, metadata, arrays)


def checkpoint_of(path: Path, metadata: Mapping[str, Any], arrays: dict[str, Any]) -> Checkpoint:
    """Return what `read_npz` has read from `path`; errors as of `load_checkpoint`."""
    require_format(path, metadata, FORMAT, VERSION)
    try:
        config = structure(metadata["config"], ReactivePlannerConfig)
        layout = structure(metadata["layout"], SensorLayout)
        agent = ReactivePlanner(layout, config)
        agent.network.restore(arrays)
        training: dict[str, Any] = dict(metadata["training"])
        agent.plannings = int(training["plannings"])
        conditions = dict(metadata.get("conditions", {}))  # files of before have none
        names = str(metadata["room"]), str(metadata["robot"])
        return Checkpoint(agent, layout, *names, training, conditions)
    except Exception as error:  # nor what numbers of any size do to a configuration
        raise corrupt(path, str(error)) from None


def structure(data: object, kind: type[_T]) -> _T:
    """Return an object that was saved as `data`; ValueError unless it would be saved so again."""
    made = cattrs.structure(data, kind)
    if json.loads(json.dumps(cattrs.unstructure(made))) != data:
        raise ValueError(f"it does not hold a whole {kind.__name__}")
    return made


def corrupt(path: Path, reason: str) -> CheckpointError:
    """Return the error of a file that does not hold what it should."""
    reason = " ".join(reason.split())
    return CheckpointError(f"checkpoint {str(path)!r} is corrupt or no checkpoint: {reason}")
