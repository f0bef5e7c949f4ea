"""Environments to act in, and the way to load them."""

from nomad_mj.envs.load import load
from nomad_mj.envs.load_options import DEFAULT_ROBOT, DEFAULT_ROOM, TASKS
from nomad_mj.envs.path_finding import PathFinding, PathFindingConfig
from nomad_mj.envs.percept import percept_of

__all__ = [
    "DEFAULT_ROBOT",
    "DEFAULT_ROOM",
    "TASKS",
    "PathFinding",
    "PathFindingConfig",
    "load",
    "percept_of",
]
