"""The table of an experiment: the paper's numbers, ours over all runs, and the baselines'."""

from collections.abc import Sequence

from nomad_agents.experiments.experiment import (
    LEARNER,
    PLANNER,
    STRAIGHT,
    Experiment,
    TableRow,
    column,
)
from nomad_agents.studies.runs import Result
from nomad_agents.studies.statistics import spread
from nomad_agents.studies.tables import TextTable, mean_cell, median_cell, total_cell
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


def for_terminal(table: TextTable) -> TextTable:
    """Return the table of an experiment without the means, where no row has one: it is wide."""
    if any(row[_IQM] for row in table.rows):
        return table
    headings, *rows = (
        (*cells[:_IQM], *cells[_IQM + 1 :]) for cells in (table.headings, *table.rows)
    )
    return TextTable(table.title, headings, tuple(rows))


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
