"""Agents by name, and configurations by name."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from nomad_agents.agent import Agent
from nomad_agents.baselines import (
    DwaConfig,
    DynamicWindow,
    Planner,
    PotentialConfig,
    PotentialField,
    RandomMoves,
    Straight,
    VectorFieldHistogram,
    VfhConfig,
)
from nomad_agents.checkpoint import checkpoint_of, read_npz
from nomad_agents.deep import LEARNERS
from nomad_agents.deep.file import FORMAT, deep_of
from nomad_agents.reactive_planner import CONFIGS, ReactivePlanner, ReactivePlannerConfig
from nomad_mj.errors import CheckpointError, ConfigError, UnknownNameError
from nomad_mj.types import SensorLayout

AGENTS: dict[str, Callable[..., Agent]] = {
    ReactivePlanner.name: ReactivePlanner,
    Planner.name: Planner,
    Straight.name: Straight,
    RandomMoves.name: RandomMoves,
    VectorFieldHistogram.name: VectorFieldHistogram,
    PotentialField.name: PotentialField,
    DynamicWindow.name: DynamicWindow,
}
# What some are told beside a configuration, as a third argument, and what is usual.
SETTINGS: Mapping[str, Any] = {
    VectorFieldHistogram.name: VfhConfig(),
    PotentialField.name: PotentialConfig(),
    DynamicWindow.name: DwaConfig(),
}


def find_config(name: str) -> ReactivePlannerConfig:
    """Return the configuration of a name; raise UnknownNameError if there is none."""
    if name not in CONFIGS:
        raise UnknownNameError("configuration", name, CONFIGS)
    return CONFIGS[name]


def make_agent(
    name: str, layout: SensorLayout, config: ReactivePlannerConfig, own: object = None
) -> Agent:
    """Return a new agent that has learnt nothing; raise UnknownNameError for an unknown name.

    `own` takes the place of its entry in `SETTINGS`.
    """
    if name not in AGENTS:
        raise UnknownNameError("agent", name, AGENTS)
    return AGENTS[name](layout, config) if own is None else AGENTS[name](layout, config, own)


def find_agent(name_or_path: str, layout: SensorLayout, config: ReactivePlannerConfig) -> Agent:
    """Return a new agent of a name, or the one that a checkpoint file holds.

    Raises
    ------
    UnknownNameError
        Neither an agent nor a file that exists.
    ConfigError
        A deep learner by name: it knows nothing before it is trained.
    CheckpointError
        A file that is no checkpoint, or one for other sensors.
    """
    if name_or_path in AGENTS:
        return make_agent(name_or_path, layout, config)
    if name_or_path in LEARNERS:
        raise ConfigError(
            f"agent {name_or_path!r} cannot act before it is trained; give the .npz file that "
            f"nomad-mj train --agent {name_or_path} writes"
        )
    path = Path(name_or_path)
    try:
        path = path.expanduser()
        exists = path.exists()
    except (OSError, RuntimeError):  # a name too long, a home that there is not
        exists = False
    if path.suffix != ".npz" and not exists:
        raise UnknownNameError("agent", name_or_path, [*AGENTS, *LEARNERS, "CHECKPOINT.npz"])
    agent = load_agent(path)
    if not agent.layout.matches(layout):
        raise CheckpointError(
            f"checkpoint {name_or_path!r} is for other sensors: "
            f"{describe_layout(agent.layout)}; this robot has {describe_layout(layout)}"
        )
    return agent


def load_agent(path: Path) -> Agent:
    """Return the agent that a file holds, of whatever kind; errors as of `load_checkpoint`."""
    metadata, arrays = read_npz(path)
    if metadata.get("format") == FORMAT:
        return deep_of(path, metadata, arrays).agent
    return checkpoint_of(path, metadata, arrays).agent


def describe_layout(layout: SensorLayout) -> str:
    """Return a robot's sensors in words."""
    rings = ", ".join(f"{len(r.bearings)} {r.name} to {r.max_range:g} m" for r in layout.rings)
    return f"{rings}, radius {layout.radius:g} m"
