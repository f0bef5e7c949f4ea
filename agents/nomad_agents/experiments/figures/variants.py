"""Variants: what leaving a part of the agent out, or changing it, does to its numbers."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from nomad_agents.studies.statistics import spread
from nomad_agents.studies.style import BLUE, FAINT, INK, grid, sheet
from nomad_mj.types import FloatArray


class Measure(NamedTuple):
    """A number compared: what it is called, and its runs (runs,) in each variant by name."""

    label: str
    runs: Mapping[str, FloatArray]


def draw_variants(measures: Sequence[Measure], path: Path, title: str) -> None:
    """Draw each variant's runs as dots, and over them interquartile mean and 95 % interval.

    Parameters
    ----------
    measures : sequence of Measure
        Side by side; a line goes down from the first variant, with which the others compare.
        Where some runs have no such number, it is written how many have.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    title : str
        Stands above.
    """
    names = list(dict.fromkeys(name for measure in measures for name in measure.runs))
    width, height = 2.6 + 3.4 * len(measures), 1.3 + 0.42 * len(names)
    with sheet(path, width, height) as figure:
        row = figure.subplots(1, len(measures), sharey=True, squeeze=False)[0].tolist()
        for axes, measure in zip(row, measures, strict=True):
            for number, name in enumerate(names):
                _draw_runs(axes, measure.runs.get(name, np.empty(0)), number, first=number == 0)
            axes.set_xlabel(measure.label)
            axes.xaxis.set_major_locator(MaxNLocator(5))
            axes.spines["left"].set_visible(False)
            axes.tick_params(axis="y", length=0)
            grid(axes, "x")
        row[0].set_yticks(range(len(names)), names)
        row[0].set_ylim(len(names) - 0.5, -0.5)
        figure.suptitle(title, x=0.01, ha="left", fontsize=13)


def _draw_runs(axes: Axes, values: FloatArray, place: int, *, first: bool) -> None:
    over = spread([values])
    if over.count < len(values):
        side = axes.get_yaxis_transform()
        said = f"{over.count} of {len(values)}"
        axes.text(1.01, place, said, va="center", fontsize=10, transform=side)
    if not over.count:
        return
    if first:
        axes.axvline(over.iqm, color=FAINT, lw=1, ls=(0, (4, 3)), zorder=1)
    # Equal numbers lie above each other, in an order that nobody drew by chance.
    off = 0.3 * ((np.arange(len(values)) * 0.618) % 1.0 - 0.5)
    axes.plot(values, place + off, "o", color=BLUE, ms=3.4, alpha=0.4, mew=0, zorder=2)
    if np.isfinite(over.low):
        axes.plot([over.low, over.high], [place, place], color=INK, lw=3, zorder=3)
    axes.plot(over.iqm, place, "o", mfc="white", mec=INK, mew=2, ms=8, zorder=4)
