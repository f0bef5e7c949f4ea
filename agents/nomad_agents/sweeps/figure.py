"""A sweep: a number of all runs against the options that were swept."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator, NullLocator
from matplotlib.transforms import ScaledTranslation

from nomad_agents.studies.statistics import spread
from nomad_agents.studies.style import (
    BLUE,
    GOAL,
    INK,
    ORANGE,
    RED,
    VIOLET,
    grid,
    legend_below,
    sheet,
)
from nomad_mj.types import FloatArray

_SIGNS = ((BLUE, "o"), (ORANGE, "s"), (GOAL, "^"), (VIOLET, "D"), (RED, "v"), (INK, "P"))
_ACROSS = 4  # panels side by side
_LONG = 28  # letters below a panel
_WIDE_RANGE = 20.0  # largest / least value from which an axis is logarithmic
_BREADTH = 0.2, 0.6  # of the distance between numbers, names, that series take side by side
_ASIDE = 5 / 72  # [in] the runs' dots stand off their mean
_PANEL = (3.1, 2.5)  # [in]


class Series(NamedTuple):
    """A value of the option told by colour; the runs' numbers (runs,) at each tick."""

    name: str
    runs: Sequence[FloatArray]


class Panel(NamedTuple):
    """What is drawn on axes of its own, and what stands above."""

    title: str
    series: Sequence[Series]


def draw_sweep(
    panels: Sequence[Panel],
    ticks: Sequence[float | str],
    labels: tuple[str, str, str],
    path: Path,
) -> None:
    """Draw every run as a dot, over them interquartile mean and 95 % interval.

    Means at numbers are joined by a line, those at names are not.

    Parameters
    ----------
    panels : sequence of Panel
        Of the same series, on the same scale.
    ticks : sequence of float or str
        What goes along the axis below.
    labels : tuple of str
        Names of the axis below, of the number, and of the option told by colour.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    """
    down = math.ceil(len(panels) / _ACROSS)
    across = math.ceil(len(panels) / down)
    series = panels[0].series
    told = any(each.name for each in series)
    broad = _PANEL[0] if len(panels) > 1 else 5.2
    size = 0.8 + broad * across, 0.5 + _PANEL[1] * down + 0.4 * told + 0.6 * (len(panels) == 1)
    with sheet(path, *size) as figure:
        grown = figure.subplots(down, across, sharex=True, sharey=True, squeeze=False)
        every: list[Axes] = grown.ravel().tolist()
        for axes, panel in zip(every, panels, strict=False):
            _draw_panel(axes, panel, ticks)
        for axes in every[len(panels) :]:
            axes.set_visible(False)
        for number, axes in enumerate(every[: len(panels)]):
            lowest = number + across >= len(panels)
            axes.tick_params(labelbottom=lowest)
            axes.set_xlabel(labels[0] if lowest else "")
        figure.supylabel(labels[1], fontsize=12, color=INK)
        if told:
            title = Line2D([], [], ls="", label=f"{labels[2]}:")
            handles = [_handle(each.name, n) for n, each in enumerate(series)]
            legend_below(figure, [title, *handles], 0)


def _handle(name: str, number: int) -> Line2D:
    colour, sign = _SIGNS[number]
    return Line2D([], [], color=colour, marker=sign, mfc="white", mew=1.8, ms=7, label=name)


def _draw_panel(axes: Axes, panel: Panel, ticks: Sequence[float | str]) -> None:
    places, step, numeric = _places(axes, ticks)
    breadth = _BREADTH[not numeric]
    for number, series in enumerate(panel.series):
        share = (number + 0.5) / len(panel.series) - 0.5 if len(panel.series) > 1 else 0.0
        at = places + breadth * step * share
        if axes.get_xscale() == "log":
            at = places * step ** (breadth * share)
        _draw_series(axes, series, at, number, joined=numeric)
    axes.set_title(panel.title, fontsize=11)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    grid(axes, "y")


def _places(axes: Axes, ticks: Sequence[float | str]) -> tuple[FloatArray, float, bool]:
    """Set the axis below; return where the values are, how far apart, and whether as numbers."""
    numbers = [tick for tick in ticks if not isinstance(tick, str)]
    if len(numbers) < len(ticks) or len(ticks) < 2:
        places = np.arange(len(ticks), dtype=np.float64)
        names = [tick if isinstance(tick, str) else f"{tick:g}" for tick in ticks]
        longest = max(len(name) for name in names) * len(names)
        axes.set_xticks(places.tolist(), names)
        if longest > _LONG:
            axes.tick_params(axis="x", labelrotation=25)
            for label in axes.get_xticklabels():
                label.set_horizontalalignment("right")
        axes.set_xlim(-0.6, len(ticks) - 0.4)
        return places, 1.0, False
    places = np.array(numbers, dtype=np.float64)
    ordered = np.sort(places)
    if ordered[0] > 0 and ordered[-1] / ordered[0] >= _WIDE_RANGE:
        axes.set_xscale("log")
        step = float((ordered[1:] / ordered[:-1]).min())
        axes.set_xlim(ordered[0] / step**0.6, ordered[-1] * step**0.6)
    else:
        step = float(np.diff(ordered).min())
        axes.set_xlim(ordered[0] - 0.6 * step, ordered[-1] + 0.6 * step)
    axes.set_xticks(ordered.tolist(), [f"{value:g}" for value in ordered])
    axes.xaxis.set_minor_locator(NullLocator())
    return places, step, True


def _draw_series(axes: Axes, series: Series, at: FloatArray, number: int, *, joined: bool) -> None:
    colour, sign = _SIGNS[number]
    over = [spread([runs]) for runs in series.runs]
    means = np.array([each.iqm for each in over])
    order = np.argsort(at)
    if joined:
        axes.plot(at[order], means[order], color=colour, lw=1.4, alpha=0.7, zorder=2)
    aside = ScaledTranslation(-_ASIDE, 0.0, axes.figure.dpi_scale_trans)
    beside = axes.transData + aside
    for place, runs, each in zip(at.tolist(), series.runs, over, strict=True):
        where = np.full(len(runs), place)
        axes.plot(
            where, runs, ".", color=colour, ms=5, alpha=0.35, mew=0, zorder=1, transform=beside
        )
        axes.update_datalim(np.column_stack([where, runs]))  # moved aside, they do not count
        if np.isfinite(each.low):
            axes.plot([place, place], [each.low, each.high], color=colour, lw=2.6, zorder=3)
    axes.plot(at, means, sign, mfc="white", mec=colour, mew=1.8, ms=7, zorder=4)
