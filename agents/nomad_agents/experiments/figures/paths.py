"""Paths (Figs 6, 13, 14): where the robot went from some starts."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from nomad_agents.experiments.figures.room import Panel, draw_robot, goal_sign, robot_sign, rooms
from nomad_agents.experiments.pictures import Way
from nomad_agents.studies.style import RED
from nomad_mj.scene import Scene

# They only tell neighbours apart.
_COLOURS = ("#2c6fbb", "#6f4aa8", "#3b8f8a", "#9a7b1c", "#4d5a68", "#8a5a44")


def draw_paths(panels: Sequence[Panel[Sequence[Way]]], path: Path, columns: int = 0) -> None:
    """Draw the ways of some episodes, a circle of the robot's size where each starts.

    Parameters
    ----------
    panels : sequence of Panel
        Ways in rooms; a way is dashed red where the goal was not reached, with a cross where it
        ended.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    columns : int
        Panels in a row, as fits well if 0.
    """
    signs = [robot_sign("start (robot's size)"), goal_sign()]
    if not all(way["reached"] for panel in panels for way in panel.content):
        lost = Line2D([], [], color=RED, ls="--", lw=1.6, marker="x", ms=8, mew=2)
        lost.set_label("did not get there")
        signs.append(lost)
    with rooms(panels, path, signs, columns) as drawn:
        for axes, panel in drawn:
            for number, way in enumerate(panel.content):
                colour = _COLOURS[number % len(_COLOURS)]
                _draw_way(axes, way, colour, panel.scene.robot.layout.radius)


def draw_starts(scene: Scene, path: Path) -> None:
    """Draw a room with its goal and its starts, circles of the robot's size with their headings."""
    signs = [robot_sign("start (robot's size)"), goal_sign()]
    starts = scene.arena.starts
    with rooms([Panel(scene.arena.name, scene, starts)], path, signs) as [(axes, _)]:
        for x, y, heading in starts.tolist():
            draw_robot(axes, (x, y), scene.robot.layout.radius, _COLOURS[0], heading)


def _draw_way(axes: Axes, way: Way, colour: str, radius: float) -> None:
    track = np.array(way["track"])
    if way["reached"]:
        axes.plot(*track.T, color=colour, lw=1.8, alpha=0.9, zorder=4)
    else:
        colour = RED
        axes.plot(*track.T, "--", color=colour, lw=1.6, dash_capstyle="butt", zorder=4)
        axes.plot(*track[-1], "x", color=colour, ms=8, mew=2, zorder=7)
    draw_robot(axes, way["track"][0], radius, colour)
