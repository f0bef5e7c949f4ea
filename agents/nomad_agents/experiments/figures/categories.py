"""Categories: which module of the network acts where, and which way it leads there."""

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.patches import Rectangle, Wedge

from nomad_agents.experiments.figures.room import Panel, draw_goal, draw_plan, room_height
from nomad_agents.experiments.pictures import Action
from nomad_agents.studies.style import INK, WIDTH, sheet
from nomad_mj.types import FloatArray, IntArray

# Pale straight to the goal, blue to the left of it, red to the right, dark away from it: cyclic,
# even, and told apart with any colour vision.
_COLOURS = matplotlib.colormaps["twilight"]
_ARROW = 0.42  # [m] from the middle to either end
_FEWEST = 3  # places in a region with an arrow
_SAME = 1e-3  # [m] between two places in the same column or row


class _Cells(NamedTuple):
    """The lattice as a raster with a margin: category, -1 for none, and move of each cell."""

    category: IntArray
    move: FloatArray
    corner: FloatArray
    side: float

    def middle(self, row: int, column: int) -> FloatArray:
        return self.corner + (np.array([column, row]) + 0.5) * self.side


def draw_categories(panel: Panel[Sequence[Action]], path: Path) -> None:
    """Draw the regions in which one category acts; places without any stay white.

    The colour says which way the category leads, measured from the direction of the goal; an arrow
    in each region of several places says it once more, in the room's directions.

    Parameters
    ----------
    panel : Panel
        Actions at the places of a square lattice.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    """
    width = WIDTH * 0.9
    with sheet(path, width + 2.0, room_height(panel.scene, width) + 0.7) as figure:
        panels = figure.subplot_mosaic(
            [["room", "."], ["room", "wheel"], ["room", "."]],
            width_ratios=[width, 2.0],
        )
        axes = panels["room"]
        draw_plan(axes, panel.scene)
        axes.set_title(panel.title)
        axes.set(xlabel="x [m]", ylabel="y [m]")
        acting = [action for action in panel.content if action["category"] >= 0]
        if acting:
            _draw_regions(axes, acting, panel.scene.arena.goal)
        draw_goal(axes, panel.scene.arena.goal)
        _draw_wheel(panels["wheel"])


def _draw_regions(axes: Axes, actions: Sequence[Action], goal: FloatArray) -> None:
    places, moves = (np.array([action[key] for action in actions]) for key in ("place", "move"))
    categories = np.array([action["category"] for action in actions], dtype=np.intp)
    cells = _raster(places, moves, categories)
    ahead = goal - places
    turned = np.arctan2(moves[:, 1], moves[:, 0]) - np.arctan2(ahead[:, 1], ahead[:, 0])
    for category in np.unique(categories):
        own = categories == category
        heading = float(np.angle(np.exp(1j * turned[own]).sum()))
        colour = _COLOURS(heading / (2 * np.pi) % 1.0)
        corners = (places[own] - cells.side / 2).tolist()
        squares = [Rectangle((x, y), cells.side, cells.side) for x, y in corners]
        axes.add_collection(PatchCollection(squares, facecolor=colour, edgecolor=colour, lw=0.4))
        _draw_arrows(axes, cells, int(category), colour)
    axes.add_collection(
        LineCollection(_borders(cells), colors=INK, linewidths=1.0, capstyle="projecting")
    )


def _raster(places: FloatArray, moves: FloatArray, categories: IntArray) -> _Cells:
    apart = [b - a for axis in places.T for a, b in itertools.pairwise(np.unique(axis).tolist())]
    side = min((step for step in apart if step > _SAME), default=1.0)
    columns, rows = np.rint((places - places.min(axis=0)) / side).astype(np.intp).T + 1
    shape = (int(rows.max()) + 2, int(columns.max()) + 2)
    category, move = np.full(shape, -1, dtype=np.intp), np.zeros((*shape, 2))
    category[rows, columns], move[rows, columns] = categories, moves
    return _Cells(category, move, places.min(axis=0) - 1.5 * side, side)


def _borders(cells: _Cells) -> list[FloatArray]:
    """Return the lines (2, 2) between cells of different categories."""
    lines: list[FloatArray] = []
    for axis in (0, 1):
        for row, column in np.argwhere(np.diff(cells.category, axis=axis) != 0):
            # Of two cells, one above or beside the other, the line at the second's near side.
            begin = np.array([column + axis, row + 1 - axis])
            end = begin + (np.array([0, 1]) if axis else np.array([1, 0]))
            lines.append(cells.corner + np.stack([begin, end]) * cells.side)
    return lines


def _draw_arrows(
    axes: Axes, cells: _Cells, category: int, colour: tuple[float, float, float, float]
) -> None:
    """Draw an arrow in each of a category's regions, in the cell nearest to its middle."""
    from scipy.ndimage import label  # takes long to import

    found: Any = label(cells.category == category)
    regions, count = found
    dark = np.dot(colour[:3], (0.299, 0.587, 0.114)) < 0.5
    for number in range(1, count + 1):
        inside = np.argwhere(regions == number)
        if len(inside) < _FEWEST:
            continue
        off = np.hypot(*(inside - inside.mean(axis=0)).T)
        middle = cells.middle(*inside[int(np.argmin(off))].tolist())
        move = cells.move[regions == number].mean(axis=0)
        half = _ARROW / 2 * move / max(float(np.hypot(*move)), 1e-9)
        axes.annotate(
            "",
            tuple((middle + half).tolist()),
            tuple((middle - half).tolist()),
            arrowprops={
                "arrowstyle": "-|>,head_width=0.22,head_length=0.4",
                "color": "white" if dark else INK,
                "lw": 1.4,
                "shrinkA": 0,
                "shrinkB": 0,
            },
        )


def _draw_wheel(axes: Axes) -> None:
    """Draw the key of the colours: which way, where the goal lies straight ahead, that is, up."""
    degrees = np.linspace(-180, 180, 73)
    for begin, end in itertools.pairwise(degrees.tolist()):
        colour = _COLOURS((begin + end) / 720 % 1.0)
        axes.add_patch(Wedge((0, 0), 1, begin + 90, end + 90.5, width=0.5, color=colour, lw=0))
    words = (("to the goal", 0, 1.12), ("away", 0, -1.12), ("left", -1.1, 0), ("right", 1.1, 0))
    for word, x, y in words:
        across = {-1.1: "right", 0: "center", 1.1: "left"}[x]
        along = {-1.12: "top", 0: "center", 1.12: "bottom"}[y]
        axes.text(x, y, word, ha=across, va=along, fontsize=11)
    axes.set(xlim=(-1.9, 1.95), ylim=(-1.5, 1.5), aspect="equal")
    axes.axis("off")
