"""Figures in the style of the paper's, drawn from plain data, each as PDF and as PNG."""

from nomad_agents.experiments.figures.actions import draw_actions
from nomad_agents.experiments.figures.paths import draw_paths, draw_starts
from nomad_agents.experiments.figures.room import Panel

__all__ = ["Panel", "draw_actions", "draw_paths", "draw_starts"]
