"""Interquartile means with their intervals, agents below each other, a panel a set."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from nomad_agents.benchmark.figures.looks import look, spoken
from nomad_agents.benchmark.figures.panels import draw_panels, panel_shape
from nomad_agents.studies.statistics import Spread
from nomad_agents.studies.style import grid, sheet


def draw_intervals(groups: Mapping[str, Mapping[str, Spread]], path: Path, score: str) -> None:
    """Draw a mark at the interquartile mean and a line over its 95 % interval.

    Parameters
    ----------
    groups : mapping of str to mapping
        By the panel's title, how the score spreads by agent.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    score : str
        What is scored.
    """
    labels = list(dict.fromkeys(label for spreads in groups.values() for label in spreads))
    rows, columns = panel_shape(len(groups))
    width, height = 2.2 + 2.5 * columns, (0.8 + 0.26 * len(labels)) * rows + 0.4
    with sheet(path, width, height) as figure:
        panels = draw_panels(figure, list(groups), score)
        for axes, spreads in zip(panels, groups.values(), strict=True):
            for label, over in spreads.items():
                seen, place = look(label), labels.index(label)
                axes.plot([over.low, over.high], [place] * 2, color=seen.colour, lw=5, alpha=0.35)
                face = seen.colour if seen.filled else "white"
                axes.plot(over.iqm, place, seen.mark, color=seen.colour, mfc=face, ms=7, mew=1.6)
            axes.set_xlim(-0.03, 1.03)
            axes.set_ylim(len(labels) - 0.4, -0.6)
            axes.set_yticks(np.arange(len(labels)), [spoken(label) for label in labels])
            axes.tick_params(axis="y", length=0)
            grid(axes, "x")
