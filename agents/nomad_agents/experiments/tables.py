"""The table of an experiment: the paper's numbers, ours over all runs, and the baselines'."""

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import rich.table
from rich.text import Text

from nomad_agents.experiments.experiment import (
    LEARNER,
    PLANNER,
    STRAIGHT,
    Experiment,
    TableRow,
    column,
)
from nomad_agents.experiments.runs import Result
from nomad_agents.experiments.statistics import Spread, spread
from nomad_mj.types import FloatArray

HEADINGS = (
    "",
    "paper",
    "ours: median [quartiles]",
    "ours: IQM (95 %)",
    "straight to the goal",
    "planner at every decision",
)
_IQM = 3
_NARROW = {
    "ours: median [quartiles]": "ours: median\n[quartiles]",
    "ours: IQM (95 %)": "ours: IQM\n(95 %)",
    "straight to the goal": "straight to\nthe goal",
    "planner at every decision": "planner at every\ndecision",
}


class TextTable(NamedTuple):
    """A table in words: the headings, and as many cells in each row."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def strata(
    results: Sequence[Result], key: str, case: str = "", agent: str = LEARNER
) -> list[FloatArray]:
    """Return one number of an agent's runs, an array for each case; see `experiment.column`."""
    cases = [case] if case else list(dict.fromkeys(result.run.case for result in results))
    if cases == [""]:
        return [column(results, key, "", agent)]
    return [column(results, key, each, agent) for each in cases]


def make_table(experiment: Experiment, results: Sequence[Result]) -> TextTable:
    """Return the table of an experiment; a cell is empty where no run has the number."""
    cases = {result.run.case for result in results}
    # Cases that make no sense with a robot or in a room are not run there.
    wanted = [row for row in experiment.table if not (row.case and cases) or row.case in cases]
    rows = [(row.label, row.paper, *_cells(row, results)) for row in wanted]
    return TextTable(f"{experiment.name}: {experiment.title}", HEADINGS, tuple(rows))


def _cells(row: TableRow, results: Sequence[Result]) -> tuple[str, str, str, str]:
    """Return what ours, its mean and the baselines are in one row of the table."""
    ours, *baselines = (
        strata(results, row.key, row.case, agent) for agent in (LEARNER, STRAIGHT, PLANNER)
    )
    if row.total:
        straight, planner = (total_cell(each) for each in baselines)
        return total_cell(ours), "", straight, planner
    straight, planner = (median_cell(each, row.digits) for each in baselines)
    return median_cell(ours, row.digits), mean_cell(spread(ours), row.digits), straight, planner


def total_cell(values: Sequence[FloatArray]) -> str:
    """Return how many runs do something, and of how many."""
    runs = np.concatenate([np.empty(0), *values])
    counted = runs[np.isfinite(runs)]
    return f"{counted.sum():.0f} of {len(counted)}" if len(counted) else ""


def median_cell(values: Sequence[FloatArray], digits: int) -> str:
    """Return median and quartiles, and how many runs have the number if not all have."""
    over = spread(values)
    if not over.count:
        return ""
    first, middle, third = (number_cell(v, digits) for v in (over.q1, over.median, over.q3))
    # Equal runs leave nothing to enclose.
    text = middle if first == middle == third else f"{middle} [{first}, {third}]"
    runs = sum(len(each) for each in values)
    return text if over.count == runs else f"{text}, {over.count} of {runs} runs"


def mean_cell(over: Spread, digits: int) -> str:
    """Return the interquartile mean and its interval."""
    if not over.count:
        return ""
    middle = number_cell(over.iqm, digits)
    if np.isnan(over.low):
        return middle
    return f"{middle} ({number_cell(over.low, digits)}, {number_cell(over.high, digits)})"


def number_cell(value: float, digits: int) -> str:
    """Return a number with so many decimals, never a negative zero."""
    text = f"{value:.{digits}f}"
    return text.removeprefix("-") if float(text) == 0 else text


def as_rich(table: TextTable) -> rich.table.Table:
    """Return a table for the terminal; an experiment's without the mean where no row has one."""
    kept = [
        number
        for number, heading in enumerate(table.headings)
        if heading != HEADINGS[_IQM] or any(row[number] for row in table.rows)
    ]
    shown = rich.table.Table(title=Text(table.title))
    for number in kept:
        heading = table.headings[number]
        narrow = _NARROW.get(heading, re.sub(r": | (?=[\[(])", "\n", heading))
        shown.add_column(Text(narrow), justify="right" if number else "left", overflow="fold")
    for row in table.rows:
        shown.add_row(*(Text(row[number]) for number in kept))  # as text: brackets are no markup
    return shown


def as_markdown(table: TextTable) -> str:
    """Return a table as Markdown, GitHub's way, without the title; it ends with a line break."""
    rule = ("---", *["---:"] * (len(table.headings) - 1))
    lines = [_line(table.headings), "|" + "|".join(rule) + "|"]
    return "\n".join([*lines, *(_line(row) for row in table.rows)]) + "\n"


def _line(cells: Sequence[str]) -> str:
    escaped = (cell.replace("\\", "\\\\").replace("|", "\\|") for cell in cells)
    return "| " + " | ".join(escaped) + " |"
