"""A grid: some options with some values each; every combination, with every seed, is a run.

An agent's own options make combinations for that agent only: with ``agent=vfh,dwa`` and
``vfh.safety=0.1,0.2`` there are three, and in dwa's the value of ``vfh.safety`` is None.
"""

import csv
import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from nomad_agents.paths import expanded
from nomad_agents.sweeps.options import (
    AGENT,
    USUAL_AGENT,
    Option,
    Value,
    catalogue,
    find_option,
    read_value,
)
from nomad_mj.errors import ConfigError
from nomad_mj.values import read_yaml

Cell = tuple[tuple[str, Value | None], ...]
_Pick = tuple[int, Value | None]  # number of a value, and the value
LARGEST = 1_000_000  # runs


class SweepRun(NamedTuple):
    """One run: (option, value) of each option of the grid, and the seed."""

    cell: Cell
    seed: int

    def __str__(self) -> str:
        return f"{describe(self.cell)}, seed {self.seed}"


def describe(cell: Cell) -> str:
    """Return a combination in words."""
    return ", ".join(f"{name}={show(value)}" for name, value in cell if value is not None)


def show(value: Value | None) -> str:
    """Return a value as it is typed, a dash for none."""
    if value is None:
        return "-"
    return str(value).lower() if isinstance(value, bool) else str(value)


def meant(cell: Cell) -> Cell:
    """Return a combination without values of options that its agent does not have."""
    agent, known = dict(cell).get(AGENT), catalogue()
    if agent is None:
        return cell
    return tuple((n, value if _has(known, agent, n) else None) for n, value in cell)


def _has(known: Mapping[str, Option], agent: Value, name: str) -> bool:
    """Return whether an agent has an option; what is no option is everyone's."""
    return name not in known or known[name].is_of(agent)


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
        found = [picks for choices in self._choices() for picks in itertools.product(*choices)]
        found.sort(key=lambda picks: [number for number, _ in picks])
        return [tuple(zip(names, (value for _, value in picks), strict=True)) for picks in found]

    def _choices(self) -> list[list[list[_Pick]]]:
        """Return, for each agent, the values of each option, with their numbers."""
        agents = dict(self.axes).get(AGENT, ())
        if not agents:
            return [[[*enumerate(values)] for _, values in self.axes]]
        known = catalogue()

        def picks(name: str, values: tuple[Value, ...], which: int) -> list[_Pick]:
            if name == AGENT:
                return [(which, values[which])]
            return [*enumerate(values)] if _has(known, agents[which], name) else [(0, None)]

        return [
            [picks(name, values, which) for name, values in self.axes]
            for which in range(len(agents))
        ]

    def runs(self) -> list[SweepRun]:
        """Return all runs, seed by seed: who stops early has all combinations, over fewer seeds."""
        cells = self.cells()
        return [SweepRun(cell, seed) for seed in range(self.seeds) for cell in cells]

    def __len__(self) -> int:
        return self.seeds * sum(math.prod(map(len, each)) for each in self._choices())

    def probes(self) -> list[Cell]:
        """Return combinations in which every value is met once, most others being the first."""
        met: set[tuple[str, Value | None]] = set()
        found: list[Cell] = []
        for cell in self.cells():
            if not met.issuperset(cell):
                met.update(cell)
                found.append(cell)
        return found


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
        held = read_yaml(expanded(path), "grid")
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
    _require_owners(axes)
    grid = Grid(tuple(axes.items()), seeds)
    if len(grid) > LARGEST:
        raise ConfigError(f"sweep: {len(grid)} runs; at most {LARGEST} can be swept at once")
    return grid


def _require_owners(axes: Mapping[str, tuple[Value, ...]]) -> None:
    """Raise ConfigError for an option that no agent of a grid has."""
    known, agents = catalogue(), axes.get(AGENT, (USUAL_AGENT,))
    for name in axes:
        if not any(known[name].is_of(agent) for agent in agents):
            raise ConfigError(
                f"sweep: {name} is an option of {', '.join(known[name].agents)}, not of "
                f"{', '.join(map(show, agents))}; choose with agent=..."
            )


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
