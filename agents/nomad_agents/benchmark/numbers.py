"""From results to the numbers that tables and figures show, by set and agent."""

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from nomad_agents.benchmark.run import BenchmarkRun
from nomad_agents.studies.runs import Result, Row
from nomad_agents.studies.statistics import Spread, spread
from nomad_mj.types import FloatArray


class Group(NamedTuple):
    """The results of one set of tasks with one robot.

    Attributes
    ----------
    name : str
        Of the set, with the robot's where there are several.
    tasks : str
        Name of the set.
    agents : dict
        Results by what the agent is called, in the order asked for.
    """

    name: str
    tasks: str
    agents: dict[str, list[Result]]


def run_of(result: Result) -> BenchmarkRun:
    """Return the run of a result of the benchmark."""
    assert isinstance(result.run, BenchmarkRun)
    return result.run


def grouped(results: Sequence[Result]) -> list[Group]:
    """Return results by set and robot, then by agent, each in the order of the results."""
    robots = {result.run.robot for result in results}
    groups: dict[str, Group] = {}
    for result in results:
        run = run_of(result)
        name = run.experiment if len(robots) == 1 else f"{run.experiment}, {run.robot}"
        group = groups.setdefault(name, Group(name, run.experiment, {}))
        group.agents.setdefault(run.label, []).append(result)
    return list(groups.values())


def strata(results: Sequence[Result], key: str) -> list[FloatArray]:
    """Return one number of each run, an array a task; NaN where a run has none.

    Parameters
    ----------
    results : sequence of Result
        Of one agent.
    key : str
        A name in the runs' rows.
    """
    cases: dict[tuple[str, str, str], list[float]] = {}
    for result in results:
        run, value = result.run, _numbers(result).get(key)
        stratum = cases.setdefault((run.experiment, run.case, run.robot), [])
        stratum.append(np.nan if value is None else float(value))
    return [np.array(values) for values in cases.values()]


def spread_of(results: Sequence[Result], key: str) -> Spread:
    """Return how one number of an agent spreads over its runs, tasks as strata."""
    # None for what is missing: no NaN equals itself, so the cache would never find it.
    known = (
        tuple(None if np.isnan(value) else value for value in values.tolist())
        for values in strata(results, key)
    )
    return _spread(tuple(known))


@cache  # tables, figures and the page ask for the same, and each takes a while
def _spread(values: tuple[tuple[float | None, ...], ...]) -> Spread:
    return spread([np.array(each, dtype=np.float64) for each in values])


def has(results: Sequence[Result], key: str) -> bool:
    """Return whether any run has a number, even an empty one."""
    return any(key in _numbers(result) for result in results)


def _numbers(result: Result) -> Row:
    """Return the numbers of a run, with those that are counted an episode or in hours."""
    row = dict(result.row)
    for key in ("virtual_collisions", "bumper_contacts"):
        row[f"{key}_per_episode"] = row[key] / max(row["episodes"], 1)
    for key in [key for key in row if "sim_s" in key]:
        seconds = row[key]
        row[key.replace("sim_s", "sim_h")] = None if seconds is None else seconds / 3600
    row["wall_min"] = result.machine.get("learn_wall_s", 0.0) / 60
    return row
