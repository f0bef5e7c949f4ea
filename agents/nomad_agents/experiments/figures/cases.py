"""Cases: how well several agents do under errors of a kind or of growing size."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from nomad_agents.studies.statistics import Spread
from nomad_agents.studies.style import (
    BLUE,
    INK,
    ORANGE,
    WIDTH,
    grid,
    legend_below,
    sheet,
)

_STYLES = ((INK, "o"), (ORANGE, "^"), (BLUE, "s"))
_ASIDE = 0.16  # between the marks of two agents, of the distance between cases


class Shares(NamedTuple):
    """A share compared: its name, and for each agent its spread over runs (0 to 1) by case."""

    label: str
    agents: Mapping[str, Mapping[str, Spread]]


def draw_cases(measures: Sequence[Shares], path: Path, title: str, *, joined: bool) -> None:
    """Draw shares in each case: interquartile means with 95 % intervals.

    Parameters
    ----------
    measures : sequence of Shares
        Side by side, of the same at most three agents.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    title : str
        Stands above.
    joined : bool
        Whether to join the cases by lines, for cases that are steps of one thing.
    """
    names = list(dict.fromkeys(name for measure in measures for name in measure.agents))
    styles = dict(zip(names, _STYLES, strict=False))
    with sheet(path, max(WIDTH, 5.0 * len(measures)), 4.6) as figure:
        row = figure.subplots(1, len(measures), sharey=True, squeeze=False)[0].tolist()
        for axes, measure in zip(row, measures, strict=True):
            cases = list(dict.fromkeys(c for by_case in measure.agents.values() for c in by_case))
            for name, by_case in measure.agents.items():
                aside = _ASIDE * (names.index(name) - (len(names) - 1) / 2)
                places = [cases.index(case) + aside for case in by_case]
                _draw_agent(axes, name, places, list(by_case.values()), styles[name], joined)
            axes.set_xticks(range(len(cases)), cases)
            if sum(map(len, cases)) > 24:
                axes.tick_params(axis="x", rotation=30)
                for text in axes.get_xticklabels():
                    text.set(ha="right", rotation_mode="anchor")
            axes.set_xlim(-0.5, len(cases) - 0.5)
            axes.set_title(measure.label, fontsize=12)
            grid(axes)
        row[0].set_ylim(0, 104)
        row[0].set_ylabel("episodes [%]")
        figure.suptitle(title, x=0.006, ha="left", fontsize=13)
        legend_below(figure, row[0].get_legend_handles_labels()[0])


def _draw_agent(
    axes: Axes,
    name: str,
    places: Sequence[float],
    spreads: Sequence[Spread],
    style: tuple[str, str],
    joined: bool,
) -> None:
    colour, marker = style
    middle, low, high = (
        100 * np.array([getattr(over, key) for over in spreads]) for key in ("iqm", "low", "high")
    )
    if joined:
        axes.plot(places, middle, color=colour, lw=1.2, alpha=0.5, zorder=2)
    axes.vlines(places, low, high, color=colour, lw=2.6, zorder=3)
    axes.plot(places, middle, marker, color=colour, ms=7, mew=0, zorder=4, label=name)
