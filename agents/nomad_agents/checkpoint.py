"""Checkpoints: what an agent has learnt and how far its training is, in one ``.npz`` file.

No pickle: arrays, and one JSON text under ``metadata``.
"""

import json
import os
import tempfile
from collections.abc import Callable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import IO, Any, NamedTuple, TypeVar

import cattrs
import mujoco
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
        Goal, movers and errors of the sensors, where they are told; see `cli.task_options`.
    """

    agent: ReactivePlanner
    layout: SensorLayout
    room: str
    robot: str
    training: dict[str, Any]
    conditions: dict[str, Any]


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
        Path(temporary).chmod(0o644)
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
        "packages": {
            "nomad-mj": version("nomad-mj"),
            "mujoco": mujoco.__version__,
            "numpy": np.__version__,
        },
    }
    arrays: dict[str, Any] = {"metadata": np.array(json.dumps(metadata)), **agent.network.arrays()}
    write_atomically(path, lambda file: np.savez(file, **arrays))


def load_checkpoint(path: Path) -> Checkpoint:
    """Return what a checkpoint file holds.

    Raises
    ------
    CheckpointError
        The file is missing, corrupt, no checkpoint, or of an unknown version.
    """
    try:
        # Opened here, since numpy leaves a file open that is no zip inside.
        with path.open("rb") as raw, np.load(raw, allow_pickle=False) as file:
            arrays: dict[str, np.ndarray] = {name: file[name] for name in file.files}
        metadata: Any = json.loads(str(arrays.pop("metadata")[()]))
    except FileNotFoundError:
        raise CheckpointError(f"checkpoint {str(path)!r} does not exist") from None
    except OSError as error:
        raise CheckpointError(
            f"checkpoint {str(path)!r} cannot be read: {error.strerror or error}"
        ) from None
    except Exception as error:  # nobody lists what zip, npy and JSON raise at damaged bytes
        raise _corrupt(path, str(error) or type(error).__name__) from None
    if not isinstance(metadata, dict) or metadata.get("format") != FORMAT:
        raise CheckpointError(f"{str(path)!r} is no checkpoint of {FORMAT!r}")
    if metadata.get("version") != VERSION:
        raise CheckpointError(
            f"checkpoint {str(path)!r} is of version {metadata.get('version')}; this program reads "
            f"version {VERSION}: train again, or use the nomad-mj that wrote it"
        )
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
        raise _corrupt(path, str(error)) from None


def structure(data: object, kind: type[_T]) -> _T:
    """Return an object that was saved as `data`; ValueError unless it would be saved so again."""
    made = cattrs.structure(data, kind)
    if json.loads(json.dumps(cattrs.unstructure(made))) != data:
        raise ValueError(f"it does not hold a whole {kind.__name__}")
    return made


def _corrupt(path: Path, reason: str) -> CheckpointError:
    reason = " ".join(reason.split())
    return CheckpointError(f"checkpoint {str(path)!r} is corrupt or no checkpoint: {reason}")
