"""Actions (Figs 7-10): what an agent does at each place of a lattice."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D

from nomad_agents.experiments.figures.room import Panel, goal_sign, rooms
from nomad_agents.experiments.pictures import Action
from nomad_agents.studies.style import BLUE, INK, ORANGE, RED

_DRAWN = 0.4  # of a move's length, so that neighbours stay apart


class _Kind(NamedTuple):
    """How one kind of decision is drawn: the shape tells as much as the colour."""

    label: str
    colour: str
    face: str
    marker: str = "o"


_KINDS = {
    ("reacted", False): _Kind("learnt reaction", INK, "white"),
    ("reacted", True): _Kind("nearest reaction, unknown situation", BLUE, BLUE),
    ("planned", True): _Kind("planned", ORANGE, ORANGE, "D"),
    ("none", True): _Kind("does not know", RED, RED, "x"),
}


def draw_actions(panels: Sequence[Panel[Sequence[Action]]], path: Path, columns: int = 0) -> None:
    """Draw the action taken at each place: a sign for its kind, and a line along the move.

    Parameters
    ----------
    panels : sequence of Panel
        Actions in rooms.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    columns : int
        Panels in a row, as fits well if 0.
    """
    kinds = {_kind(action) for panel in panels for action in panel.content}
    shown = [kind for kind in _KINDS.values() if kind in kinds]
    with rooms(panels, path, [*map(_sign, shown), goal_sign()], columns) as drawn:
        for axes, panel in drawn:
            for kind in shown:
                _draw_kind(axes, kind, [a for a in panel.content if _kind(a) == kind])


def _kind(action: Action) -> _Kind:
    # What a planner by trade plans is as much by lack of a reaction as what a learner plans.
    unmatched = action["unmatched"] or action["kind"] != "reacted"
    return _KINDS[action["kind"], unmatched]


def _draw_kind(axes: Axes, kind: _Kind, actions: Sequence[Action]) -> None:
    if not actions:
        return
    places = np.array([action["place"] for action in actions])
    if kind.marker != "x":
        ends = places + _DRAWN * np.array([action["move"] for action in actions])
        axes.add_collection(
            LineCollection(list(np.stack([places, ends], axis=1)), colors=kind.colour, lw=1.4)
        )
    axes.plot(*places.T, **_marker(kind), ls="", zorder=4)


def _marker(kind: _Kind) -> dict[str, Any]:
    size = {"o": 4.6, "D": 4.2, "x": 6.0}[kind.marker]
    width = 2.0 if kind.marker == "x" else 1.2
    return {"marker": kind.marker, "ms": size, "mfc": kind.face, "mec": kind.colour, "mew": width}


def _sign(kind: _Kind) -> Line2D:
    style = "" if kind.marker == "x" else "-"
    return Line2D([], [], color=kind.colour, lw=1.4, ls=style, label=kind.label, **_marker(kind))
