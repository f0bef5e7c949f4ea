"""The benchmark's tables: all sets at a glance, each set's metrics, and what learning took."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from nomad_agents.benchmark.numbers import Group, has, spread_of, strata
from nomad_agents.studies.runs import Result
from nomad_agents.studies.tables import (
    TextTable,
    mean_cell,
    median_cell,
    number_cell,
    total_cell,
)
from nomad_mj.types import FloatArray


class Column(NamedTuple):
    """A column: its heading, the number's name in the rows, decimals, and what is said of it.

    `until`: of a number that a run may never have, median and quartiles in which it is endless.
    """

    heading: str
    key: str
    digits: int
    kind: Literal["mean", "median", "total", "until"]


AT_A_GLANCE = {
    "success_rate": "Goal reached, every set",
    "spl": "SPL, every set",
}
DRIVING = (
    Column("goal reached", "success_rate", 3, "mean"),
    Column("without a virtual collision", "strict_success_rate", 3, "mean"),
    Column("SPL", "spl", 3, "mean"),
    Column("path / shortest", "path_ratio_median", 3, "median"),
    Column("time, s", "mean_time_s", 1, "median"),
    Column("least clearance, m", "min_clearance_m", 3, "median"),
    Column("virtual collisions an episode", "virtual_collisions_per_episode", 2, "median"),
    Column("bumper contacts an episode", "bumper_contacts_per_episode", 2, "median"),
    Column("BARN score", "barn_score", 3, "mean"),
)
LEARNING = (
    Column("runs that solve every start", "learn_solved_all", 0, "total"),
    Column("decisions until then", "decisions_to_test", 0, "until"),
    Column("simulated hours until then", "sim_h_to_test", 2, "until"),
    Column("decisions until 90 %", "decisions_to_90", 0, "until"),
    Column("simulated hours until 90 %", "sim_h_to_90", 2, "until"),
    Column("decisions until 90 % unaided", "unaided_decisions_to_90", 0, "until"),
    Column("decisions in all", "learn_decisions", 0, "median"),
    Column("virtual collisions while learning", "learn_virtual_collisions", 0, "median"),
    Column("bumper contacts while learning", "learn_bumper_contacts", 0, "median"),
    Column("minutes of computing, checks included", "wall_min", 1, "median"),
)
HEADLINE = (
    Column("goal reached", "success_rate", 2, "mean"),
    Column("SPL", "spl", 2, "mean"),
    Column("decisions until 90 %", "decisions_to_90", 0, "until"),
    Column("decisions until 90 % unaided", "unaided_decisions_to_90", 0, "until"),
    Column("virtual collisions while learning", "learn_virtual_collisions", 0, "median"),
)


def glance_table(groups: Sequence[Group], key: str) -> TextTable:
    """Return the interquartile mean of one number, agents by sets, and over all of them."""
    agents = list(dict.fromkeys(agent for group in groups for agent in group.agents))
    rows: list[tuple[str, ...]] = []
    for agent in agents:
        held = [group.agents.get(agent, []) for group in groups]
        every = [result for results in held for result in results]
        columns = [*held, every] if len(groups) > 1 else held
        rows.append((agent, *(mean_cell(spread_of(each, key), 2) for each in columns)))
    names = [group.name for group in groups]
    headings = ("", *names, *(["all runs"] if len(groups) > 1 else []))
    return TextTable(AT_A_GLANCE[key], headings, tuple(rows))


def headline_table(group: Group) -> TextTable:
    """Return what matters most in one set, narrow enough for a terminal."""
    every = [result for results in group.agents.values() for result in results]
    columns = [column for column in HEADLINE if has(every, column.key)]
    return TextTable(group.name, _headings(columns), _rows(group.agents, columns))


def driving_table(group: Group) -> TextTable:
    """Return what came of the evaluation in one set."""
    return TextTable(f"{group.name}: driving", _headings(DRIVING), _rows(group.agents, DRIVING))


def learning_table(group: Group) -> TextTable | None:
    """Return what learning one set took, None if nobody learnt."""
    learners = {
        agent: results for agent, results in group.agents.items() if has(results, "learn_decisions")
    }
    if not learners:
        return None
    return TextTable(f"{group.name}: learning", _headings(LEARNING), _rows(learners, LEARNING))


def _headings(columns: Sequence[Column]) -> tuple[str, ...]:
    return ("", *(column.heading for column in columns))


def _rows(
    agents: dict[str, list[Result]], columns: Sequence[Column]
) -> tuple[tuple[str, ...], ...]:
    return tuple(
        (agent, *(_cell(results, column) for column in columns))
        for agent, results in agents.items()
    )


def _cell(results: Sequence[Result], column: Column) -> str:
    if not has(results, column.key):
        return ""
    values = strata(results, column.key)
    if column.kind == "total":
        return total_cell(values)
    if column.kind == "mean":
        return mean_cell(spread_of(results, column.key), column.digits)
    if column.kind == "until":
        return until_cell(np.concatenate(values), column.digits)
    return median_cell(values, column.digits)


def until_cell(values: FloatArray, digits: int) -> str:
    """Return median and quartiles of values (runs,), NaN where a run never got there.

    It says how many did if not all: leaving them out would make quick of who fails often.
    """
    got = int(np.count_nonzero(~np.isnan(values)))
    if not got:
        return "never"
    over = quartiles(np.where(np.isnan(values), np.inf, values))
    cells = ["never" if np.isinf(value) else number_cell(value, digits) for value in over]
    text = cells[1] if len(set(cells)) == 1 else f"{cells[1]} [{cells[0]}, {cells[2]}]"
    return text if got == len(values) else f"{text}, {got} of {len(values)} runs get there"


def quartiles(values: FloatArray) -> tuple[float, float, float]:
    """Return the quartiles of values (runs,), of which some may be infinite, none negatively."""
    ordered = np.sort(values)
    places = (len(values) - 1) * np.array([0.25, 0.5, 0.75])
    below, above = ordered[np.floor(places).astype(int)], ordered[np.ceil(places).astype(int)]
    share = places - np.floor(places)
    with np.errstate(invalid="ignore"):
        between = np.where(np.isinf(above) & (share > 0), np.inf, below + share * (above - below))
    first, middle, third = np.where(below == above, below, between).tolist()
    return first, middle, third
