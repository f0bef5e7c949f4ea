"""Learning curves: what learning has brought and has cost, against the reactions it has taken."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from nomad_agents.studies.runs import Row
from nomad_agents.studies.style import (
    BLUE,
    INK,
    ORANGE,
    RED,
    VIOLET,
    WIDTH,
    grid,
    legend_below,
    sheet,
)
from nomad_mj.types import FloatArray

Curve = Sequence[Row]
_PANELS = {
    "solved": "starts solved [%]",
    "virtual_collisions": "virtual collisions",
    "plannings": "plannings",
}
_MOST_POINTS, _MOST_MARKS = 400, 40  # of a line
_COLOURS = (INK, ORANGE, BLUE, VIOLET)


def draw_learning(
    groups: Mapping[str, Sequence[Curve]],
    path: Path,
    title: str,
    paper: Mapping[str, tuple[float, float]] | None = None,
) -> None:
    """Draw the curves of all runs, thin, and their median, thick.

    A run that has learnt all goes on as it ended, so that the median is always that of all runs.

    Parameters
    ----------
    groups : mapping
        Name and curves of what is compared, at most four; a curve has an entry a pass, see
        `runs.Result`.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    title : str
        Stands above.
    paper : mapping, optional
        The paper's point, reactions and number, in the panels "solved" (in percent),
        "virtual_collisions", "plannings".
    """
    with sheet(path, WIDTH, 7.2) as figure:
        panels = figure.subplots(len(_PANELS), 1, sharex=True)
        for axes, (key, label) in zip(panels, _PANELS.items(), strict=True):
            for colour, curves in zip(_COLOURS, groups.values(), strict=False):
                _draw_group(axes, [_points(curve, key) for curve in curves if curve], colour)
            if paper and key in paper:
                axes.plot(*paper[key], "D", color=RED, ms=8, zorder=6, clip_on=False)
            axes.set_ylabel(label)
            axes.set_ylim(bottom=0)
            grid(axes)
        panels[0].set_ylim(0, 104)
        panels[0].set_title(title)
        panels[-1].set_xlim(left=0)
        panels[-1].set_xlabel("reactions while learning")
        figure.align_ylabels(panels)
        legend_below(
            figure,
            _signs({name: len(curves) for name, curves in groups.items()}, bool(paper)),
            3 if len(groups) < 2 else 2,
        )


def _points(curve: Curve, key: str) -> FloatArray:
    """Return reactions and number (2, n) after each pass; costs begin at nothing."""
    reactions = [float(entry["reactions"]) for entry in curve]
    if key == "solved":
        shares = [100 * entry["solved"] / max(entry["starts"], 1) for entry in curve]
        return np.array([reactions, shares])
    return np.array([[0.0, *reactions], [0.0, *(float(entry[key]) for entry in curve)]])


def _draw_group(axes: Axes, curves: Sequence[FloatArray], colour: str) -> None:
    for curve in curves:
        count = curve.shape[1]
        kept = np.unique(np.linspace(0, count - 1, min(count, _MOST_POINTS)).astype(int))
        marker = "o" if count <= _MOST_MARKS else ""
        axes.plot(
            *curve[:, kept], color=colour, marker=marker, lw=0.9, ms=2.6, alpha=0.35, zorder=3
        )
    if len(curves) > 1:
        axes.plot(*_median(curves), color=colour, lw=2.6, zorder=4)


def _median(curves: Sequence[FloatArray]) -> FloatArray:
    """Return the median (2, n), from where all curves have begun."""
    begun = max(curve[0, 0] for curve in curves)
    reactions = np.linspace(begun, max(curve[0, -1] for curve in curves), _MOST_POINTS)
    values = [np.interp(reactions, *curve) for curve in curves]
    return np.array([reactions, np.median(values, axis=0)])


def _signs(groups: Mapping[str, int], paper: bool) -> list[Line2D]:
    signs: list[Line2D] = []
    for colour, (name, runs) in zip(_COLOURS, groups.items(), strict=False):
        of = f"{name}: " if name else ""
        if runs > 1:
            signs.append(Line2D([], [], color=colour, lw=2.6, label=f"{of}median"))
        signs.append(
            Line2D([], [], color=colour, marker="o", ms=3, lw=0.9, alpha=0.6, label=f"{of}a run")
        )
    if paper:
        signs.append(Line2D([], [], marker="D", ls="", color=RED, ms=8, label="paper"))
    return signs
