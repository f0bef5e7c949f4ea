"""A grid: some options with some values each; every combination, with every seed, is a run."""

import csv
import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from nomad_agents.sweeps.options import (
    Value,
    catalogue,
    find_option,
    read_value,
)
from nomad_mj.errors import ConfigError
from nomad_mj.values import read_yaml

Cell = tuple[tuple[str, Value], ...]
LARGEST = 1_000_000  # runs


class SweepRun(NamedTuple):
    """One run: (option, value) of each option of the grid, and the seed."""

    cell: Cell
    seed: int

    def __str__(self) -> str:
        return f"{describe(self.cell)}, seed {self.seed}"


def describe(cell: Cell) -> str:
    """Return a combination in words."""
    return ", ".join(f"{name}={show(value)}" for name, value in cell)


def show(value: Value) -> str:
    """Return a value as it is typed."""
    return str(value).lower() if isinstance(value, bool) else str(value)


@dataclass(frozen=True)
class Grid:
    """What is swept.

    Attributes
    ----------
    axes : tuple of (str, tuple)
        Every option that was given, with its values, in the order in which they were given.
    seeds : int
        Every combination is run with the seeds 0, 1, ...
    """

    axes: tuple[tuple[str, tuple[Value, ...]], ...]
    seeds: int

    @property
    def swept(self) -> tuple[str, ...]:
        """Names of the options with more than one value."""
        return tuple(name for name, values in self.axes if len(values) > 1)

    def cells(self) -> list[Cell]:
        """Return all combinations; the last option's values take turns first."""
        names = [name for name, _ in self.axes]
        every = itertools.product(*(values for _, values in self.axes))
        return [tuple(zip(names, values, strict=True)) for values in every]

    def runs(self) -> list[SweepRun]:
        """Return all runs, seed by seed: who stops early has all combinations, over fewer seeds."""
        cells = self.cells()
        return [SweepRun(cell, seed) for seed in range(self.seeds) for cell in cells]

    def __len__(self) -> int:
        count = self.seeds
        for _, values in self.axes:
            count *= len(values)
        return count

    def probes(self) -> list[Cell]:
        """Return combinations in which every value is met once, the others being the first."""
        first = {name: values[0] for name, values in self.axes}
        others = [
            tuple({**first, name: value}.items())
            for name, values in self.axes
            for value in values[1:]
        ]
        return [tuple(first.items()), *others]


def read_grid(words: Sequence[str], path: str, starts: str, seeds: int) -> Grid:
    """Return the grid of words ``option=value,value`` and of a YAML file of the same.

    Parameters
    ----------
    words : sequence of str
        As typed. A value that holds a comma is quoted: ``goal="8,6","3,4"``.
    path : str
        A file of keys and values or lists of values; none if empty.
    starts : str
        Of an evaluation, unless the grid says so.
    seeds : int
        How many.

    Raises
    ------
    ConfigError
        An option that there is not, or twice; a value of the wrong type, or twice; too many runs.
    ModelError
        A file that cannot be read.
    """
    if seeds < 1:
        raise ConfigError(f"seeds {seeds}: must be 1 or more")
    given: list[tuple[str, list[Any]]] = []
    if path:
        held = read_yaml(Path(path).expanduser(), "grid")
        given += [(str(k), v if isinstance(v, list) else [v]) for k, v in held.items()]
    given += [_split(word) for word in words]
    axes: dict[str, tuple[Value, ...]] = {}
    for name, values in given:
        option = find_option(name)
        if option.name in axes:
            raise ConfigError(f"sweep: {option.name} is given twice; give all its values at once")
        axes[option.name] = _distinct(option.name, (read_value(option, each) for each in values))
    if "starts" not in axes:
        axes["starts"] = (starts,)
    grid = Grid(tuple(axes.items()), seeds)
    if len(grid) > LARGEST:
        raise ConfigError(f"sweep: {len(grid)} runs; at most {LARGEST} can be swept at once")
    return grid


def _split(word: str) -> tuple[str, list[Any]]:
    name, sign, text = word.partition("=")
    if not sign or not name:
        raise ConfigError(
            f"sweep: {word!r} is no option=value,value; options are: {', '.join(catalogue())}"
        )
    return name, next(csv.reader([text], skipinitialspace=True), [])


def _distinct(name: str, values: Iterable[Value]) -> tuple[Value, ...]:
    found: dict[Value, None] = {}
    for value in values:
        if value in found or value == "":
            said = "has an empty value" if value == "" else f"has {show(value)} twice"
            raise ConfigError(f"sweep: {name} {said}")
        found[value] = None
    if not found:
        raise ConfigError(f"sweep: {name} has no value")
    return tuple(found)


def as_data(grid: Grid) -> dict[str, Any]:
    """Return a grid as plain data."""
    return {"axes": [[name, list(values)] for name, values in grid.axes], "seeds": grid.seeds}


def from_data(data: Mapping[str, Any]) -> Grid:
    """Return the grid of plain data."""
    axes = tuple((str(name), tuple(values)) for name, values in data["axes"])
    return Grid(axes, int(data["seeds"]))
