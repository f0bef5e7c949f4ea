"""What a sweep has found: each combination's numbers over its seeds, as a table and as figures."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from nomad_agents.studies.statistics import spread
from nomad_agents.studies.tables import TextTable, mean_cell, median_cell
from nomad_agents.sweeps.figure import Panel, Series, draw_sweep
from nomad_agents.sweeps.grid import Cell, Grid, meant, show
from nomad_agents.sweeps.options import Value
from nomad_agents.sweeps.store import Store
from nomad_mj.errors import ConfigError
from nomad_mj.types import FloatArray

USUAL = ("success_rate", "spl", "learn_reactions")
_LABELS = {
    "success_rate": "share that reached the goal",
    "strict_success_rate": "share without a virtual collision",
    "spl": "SPL",
    "path_ratio_median": "path / shortest path, median",
    "min_clearance_m": "least clearance [m]",
    "mean_time_s": "mean time to the goal [s]",
}
_MOST_SERIES = 6  # that colours and signs tell apart
MOST_PANELS = 24


def choose_metrics(store: Store, names: Sequence[str]) -> list[str]:
    """Return the metrics to show: those of some names, or the usual ones.

    Raises
    ------
    ConfigError
        A name that no run has a number of.
    """
    known = {
        name: None
        for row in store.rows.values()
        for name, value in row.items()
        if isinstance(value, int | float)
    }
    for name in names:
        if name not in known:
            there = ", ".join(known)
            raise ConfigError(
                f"sweep: unknown metric {name!r}; there are: {there} (what was run is on file: "
                "--only-read shows it)"
            )
    return list(dict.fromkeys(names)) or [name for name in USUAL if name in known]


def column(store: Store, cell: Cell, metric: str) -> FloatArray:
    """Return a number of a combination's runs that are done (runs,), NaN where it is missing."""
    rows = (store.rows[run] for run in store.runs_of(cell))
    return np.array([float(row.get(metric, np.nan)) for row in rows], dtype=np.float64)


def make_summary(store: Store, metrics: Sequence[str]) -> TextTable:
    """Return a row for each combination; options of one value stand in the title."""
    grid = store.grid
    headings = [*grid.swept, "runs"]
    for metric in metrics:
        headings += [f"{metric}: median [quartiles]", "IQM (95 %)"]
    rows = [_line(store, cell, metrics) for cell in grid.cells()]
    return TextTable(_title(grid), tuple(headings), tuple(rows))


def _line(store: Store, cell: Cell, metrics: Sequence[str]) -> tuple[str, ...]:
    swept = set(store.grid.swept)
    line = [show(value) for name, value in cell if name in swept]
    line.append(str(len(store.runs_of(cell))))
    for metric in metrics:
        values, digits = column(store, cell, metric), _digits(metric, store)
        line += [median_cell([values], digits), mean_cell(spread([values]), digits)]
    return tuple(line)


def _digits(metric: str, store: Store) -> int:
    """Return how many decimals a number is shown with: none if it counts."""
    values = (row[metric] for row in store.rows.values() if metric in row)
    return (
        0 if all(isinstance(value, int) and not isinstance(value, bool) for value in values) else 3
    )


def _title(grid: Grid) -> str:
    fixed = [f"{name}={show(values[0])}" for name, values in grid.axes if len(values) == 1]
    return ", ".join(["sweep", *fixed])


def draw(store: Store, metrics: Sequence[str], folder: Path) -> tuple[list[Path], int]:
    """Draw a figure for each metric, ``sweep_METRIC``; return the PNG files and panels left out.

    Along the axis below goes the first option of numbers, or the first of all; in colours the
    first of few values among the others; the rest is panels side by side. What an agent is not
    told makes no difference to it: it is drawn alike at all values.
    """
    grid = store.grid
    values = dict(grid.axes)
    swept = list(grid.swept) or [grid.axes[0][0]]
    below = next((name for name in swept if _numeric(values[name])), swept[0])
    others = [name for name in swept if name != below]
    colour = next((name for name in others if len(values[name]) <= _MOST_SERIES), "")
    apart = Grid(tuple((n, values[n]) for n in others if n != colour), 1).cells()
    paths: list[Path] = []
    for metric in metrics:
        panels = [
            Panel(
                ", ".join(f"{name} = {show(value)}" for name, value in panel if value is not None),
                [
                    Series(show(one) if colour else "", _points(store, metric, below, panel, extra))
                    for one in values.get(colour, ("",))
                    for extra in [{colour: one} if colour else {}]
                ],
            )
            for panel in apart[:MOST_PANELS]
        ]
        path = folder / f"sweep_{metric}"
        labels = below, _label(metric), colour
        draw_sweep(panels, [_tick(value) for value in values[below]], labels, path)
        paths.append(path.with_name(f"{path.name}.png"))
    return paths, max(len(apart) - MOST_PANELS, 0)


def _points(
    store: Store, metric: str, below: str, panel: Cell, extra: Mapping[str, Value]
) -> list[FloatArray]:
    """Return the runs' numbers at each value of the option that goes along the axis."""
    fixed = {**dict(panel), **extra}
    single = {name: values[0] for name, values in store.grid.axes}
    found: list[FloatArray] = []
    for value in dict(store.grid.axes)[below]:
        cell = tuple({**single, **fixed, below: value}.items())
        found.append(column(store, meant(cell), metric))
    return found


def _numeric(values: Sequence[Value]) -> bool:
    return all(isinstance(v, int | float) and not isinstance(v, bool) for v in values)


def _tick(value: Value) -> float | str:
    return show(value) if isinstance(value, bool | str) else float(value)


def _label(metric: str) -> str:
    learnt = metric.removeprefix("learn_")
    if learnt != metric:
        return f"{learnt.replace('_', ' ')} while learning"
    return _LABELS.get(metric, metric.replace("_", " "))
