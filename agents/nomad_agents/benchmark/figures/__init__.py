"""Figures of the benchmark: numbers -> PDF and PNG."""

from nomad_agents.benchmark.figures.efficiency import draw_efficiency
from nomad_agents.benchmark.figures.intervals import draw_intervals
from nomad_agents.benchmark.figures.profiles import draw_profiles

__all__ = ["draw_efficiency", "draw_intervals", "draw_profiles"]
