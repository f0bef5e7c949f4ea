"""A deep learner's policy in one ``.npz`` file: the arrays of its network, and JSON; no pickle."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import cattrs

from nomad_agents.checkpoint import (
    corrupt,
    packages,
    read_npz,
    require_format,
    structure,
    write_npz,
)
from nomad_agents.deep.agent import DeepAgent
from nomad_agents.deep.policy import policy_from
from nomad_agents.deep.settings import LEARNERS
from nomad_mj.errors import CheckpointError
from nomad_mj.perception import OBSERVATIONS, SituationSpec
from nomad_mj.types import SensorLayout

FORMAT = "nomad_mj.deep_policy"
VERSION = 1


class DeepFile(NamedTuple):
    """What a file of a deep learner holds.

    Attributes
    ----------
    agent : DeepAgent
        What was learnt.
    room, robot : str
        Where and with what.
    training : dict
        How far training was (``seed``, ``decisions``, ``sim_s``, ``packages``), as data.
    conditions : dict
        Goal, movers and errors of the sensors; see `task_options`.
    """

    agent: DeepAgent
    room: str
    robot: str
    training: dict[str, Any]
    conditions: dict[str, Any]


def save_deep(path: Path, content: DeepFile) -> None:
    """Write a deep learner's file, whole or not at all; errors as of `write_atomically`."""
    agent = content.agent
    metadata = {
        "format": FORMAT,
        "version": VERSION,
        "agent": agent.name,
        "settings": cattrs.unstructure(agent.settings),
        "observation": agent.observation,
        "situation": cattrs.unstructure(agent.situation),
        "network": {"hidden": agent.policy.hidden, "bound": agent.policy.bound},
        "layout": cattrs.unstructure(agent.layout),
        "room": content.room,
        "robot": content.robot,
        "training": content.training,
        "conditions": content.conditions,
        "packages": packages(),
    }
    write_npz(path, metadata, agent.policy.arrays())


def load_deep(path: Path) -> DeepFile:
    """Return what a deep learner's file holds.

    Raises
    ------
    CheckpointError
        The file is missing, corrupt, of another kind, or of an unknown version.
    """
    metadata, arrays = read_npz(path)
    return deep_of(path, metadata, arrays)


def deep_of(path: Path, metadata: Mapping[str, Any], arrays: dict[str, Any]) -> DeepFile:
    """Return what `read_npz` has read from `path`; errors as of `load_deep`."""
    require_format(path, metadata, FORMAT, VERSION)
    try:
        network, observation = metadata["network"], metadata["observation"]
        if observation not in OBSERVATIONS:
            raise ValueError(f"an observation {observation!r} unknown here")
        agent = DeepAgent(
            structure(metadata["layout"], SensorLayout),
            structure(metadata["situation"], SituationSpec),
            observation,
            policy_from(arrays, network["hidden"], network["bound"]),
            structure(metadata["settings"], LEARNERS[metadata["agent"]]),
        )
        names = str(metadata["room"]), str(metadata["robot"])
        return DeepFile(agent, *names, dict(metadata["training"]), dict(metadata["conditions"]))
    except CheckpointError:
        raise
    except Exception as error:  # nobody lists what wrong data do to a network or a configuration
        raise corrupt(path, str(error) or type(error).__name__) from None
