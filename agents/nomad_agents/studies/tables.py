"""Tables as text: what their cells say of numbers over runs, on the terminal and as Markdown."""

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import rich.table
from rich.text import Text

from nomad_agents.studies.statistics import Spread, spread
from nomad_mj.types import FloatArray

_LONG = 14  # letters of a heading in a line


class TextTable(NamedTuple):
    """A table in words: the headings, and as many cells in each row."""

    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


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
    """Return a table for the terminal, as narrow as can be."""
    shown = rich.table.Table(title=Text(table.title))
    for number, heading in enumerate(table.headings):
        lines = re.sub(r": | (?=[\[(])", "\n", heading).split("\n")
        narrow = Text("\n".join(_halved(line) for line in lines))
        shown.add_column(narrow, justify="right" if number else "left", overflow="fold")
    for row in table.rows:
        shown.add_row(*(Text(cell) for cell in row))  # as text: brackets are no markup
    return shown


def _halved(line: str) -> str:
    """Return a long line of a heading as two, broken at the space nearest its middle."""
    spaces = [found.start() for found in re.finditer(" ", line)]
    if len(line) <= _LONG or not spaces:
        return line
    middle = min(spaces, key=lambda at: abs(at - len(line) / 2))
    return f"{line[:middle]}\n{line[middle + 1 :]}"


def without_empty_columns(table: TextTable) -> tuple[list[str], list[list[str]]]:
    """Return headings and rows without the columns in which no row has anything; keep the first."""
    kept = [n for n in range(len(table.headings)) if n == 0 or any(row[n] for row in table.rows)]
    return [table.headings[n] for n in kept], [[row[n] for n in kept] for row in table.rows]


def as_markdown(table: TextTable) -> str:
    """Return a table as Markdown, GitHub's way, without the title; it ends with a line break."""
    rule = ("---", *["---:"] * (len(table.headings) - 1))
    lines = [_line(table.headings), "|" + "|".join(rule) + "|"]
    return "\n".join([*lines, *(_line(row) for row in table.rows)]) + "\n"


def _line(cells: Sequence[str]) -> str:
    escaped = (cell.replace("\\", "\\\\").replace("|", "\\|") for cell in cells)
    return "| " + " | ".join(escaped) + " |"
