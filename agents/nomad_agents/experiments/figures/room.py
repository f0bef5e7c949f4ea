"""The room seen from above: walls and obstacles, the goal, the robot as a disc."""

from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

import numpy as np
import shapely
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon, Rectangle
from matplotlib.ticker import MaxNLocator

from nomad_agents.studies.style import GOAL, INK, OBSTACLE, legend_below, sheet
from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray

GOAL_SIDE = 0.4  # [m]
_WIDEST, _PAGE = 5.8, 12.0  # [in] of a panel, of all panels beside each other
_TITLE, _BESIDE, _BELOW = 0.4, 0.6, 0.9  # [in] above each room, beside the first, below all
_COLUMNS = {1: 1, 2: 2, 3: 3, 4: 2}
Content_co = TypeVar("Content_co", covariant=True)


@dataclass(frozen=True)
class Panel(Generic[Content_co]):
    """A room with something drawn in it.

    Attributes
    ----------
    title : str
        Stands above.
    scene : Scene
        The room with its goal, and the robot.
    content : object
        What is drawn, such as ways.
    """

    title: str
    scene: Scene
    content: Content_co


def room_height(scene: Scene, width: float) -> float:
    """Return how high [in] a room is that is drawn so wide."""
    x0, y0, x1, y1 = scene.shown_bounds
    return width * (y1 - y0) / (x1 - x0)


@contextmanager
def rooms(
    panels: Sequence[Panel[Content_co]], path: Path, signs: Sequence[Artist], columns: int = 0
) -> Generator[list[tuple[Axes, Panel[Content_co]]], None, None]:
    """Yield a room to draw in for each panel: in metres, with its goal; then write the figure.

    Parameters
    ----------
    panels : sequence of Panel
        Row by row.
    path : Path
        Without a suffix.
    signs : sequence of Artist
        Explained below.
    columns : int
        Panels in a row, as fits well if 0.
    """
    columns = columns or _COLUMNS.get(len(panels), 3)
    rows = max(-(-len(panels) // columns), 1)
    width = min(_WIDEST, _PAGE / columns)
    drawn = width - _BESIDE / columns
    highest = max((room_height(panel.scene, drawn) for panel in panels), default=drawn)
    sizes = {panel.scene.shown_bounds for panel in panels}
    with sheet(path, width * columns, rows * (highest + _TITLE) + _BELOW) as figure:
        grid = figure.subplots(rows, columns, squeeze=False).ravel().tolist()
        for axes, panel in zip(grid, panels, strict=False):
            draw_plan(axes, panel.scene)
            draw_goal(axes, panel.scene.arena.goal)
            axes.set_title(panel.title)
            axes.set(xlabel="x [m]", ylabel="y [m]")
            if len(sizes) == 1:
                axes.label_outer()
        for axes in grid[len(panels) :]:
            axes.axis("off")
        yield list(zip(grid, panels, strict=False))
        legend_below(figure, signs)


def draw_plan(axes: Axes, scene: Scene) -> None:
    """Draw the floor plan in metres, to equal scales and without a frame."""
    x0, y0, x1, y1 = scene.shown_bounds
    patches = [Polygon(shapely.get_coordinates(shape)) for shape in scene.plan.footprints]
    axes.add_collection(PatchCollection(patches, facecolor=OBSTACLE, edgecolor=OBSTACLE, lw=0.5))
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(6, integer=True))
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def draw_goal(axes: Axes, place: Sequence[float] | FloatArray) -> None:
    """Draw the goal, a square, at x, y [m]."""
    x, y = (float(value) - GOAL_SIDE / 2 for value in place)
    axes.add_patch(Rectangle((x, y), GOAL_SIDE, GOAL_SIDE, facecolor=GOAL, zorder=5))


def draw_robot(
    axes: Axes,
    place: Sequence[float],
    radius: float,
    colour: str = INK,
    heading: float | None = None,
) -> None:
    """Draw the robot, a disc of its size; with a line from the centre to where its wheels head."""
    x, y = place[:2]
    axes.add_patch(Circle((x, y), radius, facecolor="white", edgecolor=colour, lw=1.4, zorder=6))
    if heading is not None:
        tip = x + radius * np.cos(heading), y + radius * np.sin(heading)
        axes.plot([x, tip[0]], [y, tip[1]], color=colour, lw=1.4, zorder=7)


def robot_sign(label: str) -> Line2D:
    """Return what stands for the robot in a legend."""
    return Line2D([], [], marker="o", ls="", mfc="white", mec=INK, mew=1.4, ms=10, label=label)


def goal_sign() -> Line2D:
    """Return what stands for the goal in a legend."""
    return Line2D([], [], marker="s", ls="", color=GOAL, ms=9, label="goal")
