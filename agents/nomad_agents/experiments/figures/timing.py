"""Timing: what a reaction and a planning take, the more the agent has learnt."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import EngFormatter, StrMethodFormatter

from nomad_agents.studies.style import BLUE, INK, WIDTH, grid, sheet
from nomad_mj.types import FloatArray

PAPER_EXEMPLARS, PAPER_REACTION, PAPER_PLANNING = 93, 0.04, 1.6  # section 4; [s]
_READABLE = EngFormatter("s")


def draw_timing(
    reactions: Sequence[Sequence[float]],
    plannings: Sequence[Sequence[float]],
    path: Path,
    title: str,
) -> None:
    """Draw the time of a decision against the number of exemplars, both logarithmic.

    Parameters
    ----------
    reactions, plannings : sequence of (exemplars, seconds)
        Measured; a line joins the medians where a number of exemplars was measured repeatedly.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    title : str
        Stands above.
    """
    with sheet(path, WIDTH, 4.6) as figure:
        axes = figure.subplots()
        for name, pairs, paper, colour, marker, up in (
            ("a planning", plannings, PAPER_PLANNING, BLUE, "s", 1),
            ("a reaction", reactions, PAPER_REACTION, INK, "o", -1),
        ):
            axes.plot(PAPER_EXEMPLARS, paper, marker, ms=9, mfc="white", mec=colour, mew=2)
            _say(axes, f"{name}, paper: {_READABLE(paper)}", (PAPER_EXEMPLARS, paper), colour, 0)
            if pairs:
                axes.plot(*np.array(pairs).T, marker, color=colour, ms=3, alpha=0.3, mew=0)
                line = _medians(np.array(pairs, dtype=np.float64))
                axes.plot(*line, "-", marker=marker, color=colour, lw=2, ms=6)
                count, seconds = line[:, np.abs(np.log(line[0] / PAPER_EXEMPLARS)).argmin()]
                # Above the upper line and below the lower one.
                said = f"{name}, here: {_READABLE(float(f'{seconds:.2g}'))}"
                _say(axes, said, (count, seconds), colour, up)
        axes.set(xscale="log", yscale="log", xlabel="exemplars", ylabel="time of a decision")
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.yaxis.set_major_formatter(EngFormatter("s"))
        axes.margins(0.1, 0.12)
        axes.set_title(title)
        grid(axes)


def _say(axes: Axes, text: str, at: tuple[float, float], colour: str, up: int) -> None:
    """Write beside a point, or above (up = 1) or below it (-1)."""
    axes.annotate(
        text,
        at,
        xytext=(-5 if up else 10, 16 * up),
        textcoords="offset points",
        va="center",
        color=colour,
    )


def _medians(pairs: FloatArray) -> FloatArray:
    """Return each number of exemplars, ascending, and the median of its times (2, n)."""
    counts = np.unique(pairs[:, 0])
    return np.array([counts, [np.median(pairs[pairs[:, 0] == count, 1]) for count in counts]])
