"""Agents to compare with: they learn nothing."""

from nomad_agents.baselines.dwa import DwaConfig, DynamicWindow
from nomad_agents.baselines.planner import Planner
from nomad_agents.baselines.potential import PotentialConfig, PotentialField
from nomad_agents.baselines.random_moves import RandomMoves
from nomad_agents.baselines.straight import Straight
from nomad_agents.baselines.vfh import VectorFieldHistogram, VfhConfig

__all__ = [
    "DwaConfig",
    "DynamicWindow",
    "Planner",
    "PotentialConfig",
    "PotentialField",
    "RandomMoves",
    "Straight",
    "VectorFieldHistogram",
    "VfhConfig",
]
