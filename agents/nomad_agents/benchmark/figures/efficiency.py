"""How well agents drive after so many decisions of learning, on a logarithmic axis."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from nomad_agents.benchmark.checks import MASTERED
from nomad_agents.benchmark.efficiency import Efficiency
from nomad_agents.benchmark.figures.looks import Look, look, spoken
from nomad_agents.studies.style import FAINT, INK, grid, legend_below, sheet

_WIDTH, _HEIGHT = 8.6, 5.4  # [in]
_FIRST = 10  # decisions: what was there before learning is drawn here
_THIN = 1.2  # [pt], a line beside another of the same agent
_APART = 4.2  # percent between two words at the right


def draw_efficiency(
    curves: Mapping[str, Efficiency],
    unaided: Mapping[str, Efficiency],
    levels: Mapping[str, float],
    path: Path,
    title: str,
) -> None:
    """Draw median and quartiles of the success rate, a line a learner.

    Parameters
    ----------
    curves, unaided : mapping
        By agent, as it drives and, of some, without what taught it.
    levels : mapping
        By agent, the success rate of those that do not learn.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    title : str
        Stands above.
    """
    with sheet(path, _WIDTH, _HEIGHT) as figure:
        axes = figure.subplots()
        ends = [curve.decisions[-1] for curve in (*curves.values(), *unaided.values())]
        last = max(2 * _FIRST, *ends)
        axes.set_xscale("log")
        axes.set_xlim(_FIRST, last * 1.05)
        axes.set_ylim(-2, 103)
        axes.axhline(100 * MASTERED, color=FAINT, lw=0.8, zorder=1)
        for label, curve in curves.items():
            _draw(axes, curve, look(label), last, thin=label in unaided)
        for label, curve in unaided.items():
            _draw(axes, curve, look(label), last)
        for label, level in levels.items():
            axes.axhline(100 * level, color=look(label).colour, lw=1.4, ls=(0, (1, 1.6)), zorder=2)
        _name_levels(axes, levels)
        axes.set_title(title)
        axes.set_xlabel("decisions of learning")
        axes.set_ylabel("unseen starts solved [%]")
        grid(axes, "both")
        legend_below(figure, _signs(curves, unaided), 3)


def _draw(axes: Axes, curve: Efficiency, seen: Look, last: float, *, thin: bool = False) -> None:
    """Draw a curve, to the end of the figure as it ended, and a mark where 90 % is reached."""
    decisions = np.maximum([*curve.decisions, last], _FIRST)
    low, median, high = (
        100 * np.append(each, each[-1]) for each in (curve.low, curve.median, curve.high)
    )
    width = _THIN if thin else seen.width
    axes.plot(decisions, median, color=seen.colour, ls=seen.style, lw=width, zorder=4)
    if not thin:
        axes.fill_between(decisions, low, high, color=seen.colour, alpha=0.14, lw=0)
    if np.isfinite(curve.mastered) and not thin:
        face = seen.colour if seen.filled else "white"
        axes.plot(
            max(curve.mastered, _FIRST), 100 * MASTERED, seen.mark, color=seen.colour, mfc=face,
            ms=10, mew=1.8, zorder=6, clip_on=False,
        )  # fmt: skip


def _name_levels(axes: Axes, levels: Mapping[str, float]) -> None:
    """Name the levels beside the figure, none over another."""
    ordered = sorted(levels.items(), key=lambda item: item[1])
    for (label, level), place in zip(ordered, spread_out([v for _, v in ordered]), strict=True):
        axes.annotate(
            spoken(label),
            (1.0, 100 * level),
            (1.02, place),
            xycoords=axes.get_yaxis_transform(),
            color=look(label).colour,
            va="center",
            fontsize=11,
            arrowprops={"arrowstyle": "-", "color": look(label).colour, "lw": 0.7, "shrinkB": 0},
        )


def spread_out(levels: Sequence[float]) -> list[float]:
    """Return places [%] near rising levels, far enough from each other and not above all."""
    places: list[float] = []
    for level in levels:
        places.append(max(100 * level, places[-1] + _APART if places else -np.inf))
    top = 103.0
    for number in reversed(range(len(places))):
        places[number] = min(places[number], top)
        top = places[number] - _APART
    return places


def _signs(curves: Mapping[str, Efficiency], unaided: Mapping[str, Efficiency]) -> list[Line2D]:
    signs: list[Line2D] = []

    def add(label: str, words: str, width: float) -> None:
        seen = look(label)
        signs.append(Line2D([], [], color=seen.colour, ls=seen.style, lw=width, label=words))

    for label in curves:
        name = spoken(label)
        if label in unaided:
            add(label, f"{name}: reactions alone", look(label).width)
            add(label, f"{name}: with its planner", _THIN)
        else:
            add(label, name, look(label).width)
    signs.append(Line2D([], [], color=INK, ls=(0, (1, 1.6)), lw=1.4, label="does not learn"))
    return signs
