"""From results on file to what people look at: tables, rows, figures and the page."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from nomad_agents.benchmark.numbers import Group, grouped, spread_of
from nomad_agents.benchmark.page import Part, write_page
from nomad_agents.benchmark.pictures import draw_all, draw_learning
from nomad_agents.benchmark.sets import SETS
from nomad_agents.benchmark.tables import (
    AT_A_GLANCE,
    driving_table,
    glance_table,
    headline_table,
    learning_table,
)
from nomad_agents.checkpoint import write_atomically
from nomad_agents.studies.export import export
from nomad_agents.studies.runs import Result
from nomad_agents.studies.tables import TextTable, as_markdown

TOLD = ("success_rate", "strict_success_rate", "spl", "barn_score")


def glances(groups: Sequence[Group]) -> list[TextTable]:
    """Return the tables of all sets at a glance."""
    return [glance_table(groups, key) for key in AT_A_GLANCE]


def terminal_tables(groups: Sequence[Group]) -> list[TextTable]:
    """Return what a terminal has room for: one set's headlines, or all sets at a glance."""
    return [headline_table(groups[0])] if len(groups) == 1 else glances(groups)


def group_tables(group: Group) -> list[TextTable]:
    """Return the tables of one set."""
    learning = learning_table(group)
    return [driving_table(group), *([learning] if learning else [])]


def write_tables(groups: Sequence[Group], command: str, path: Path) -> None:
    """Write all tables as Markdown."""
    tables = [*glances(groups), *(table for group in groups for table in group_tables(group))]
    parts = [f"`{command}`\n", *(f"## {each.title}\n\n{as_markdown(each)}" for each in tables)]
    write_atomically(path, lambda file: file.write("\n".join(parts).encode()))


def present(results: Sequence[Result], command: str, folder: Path, page: Path) -> None:
    """Write tables, rows, figures and the page.

    Parameters
    ----------
    results : sequence of Result
        All there are.
    command : str
        What to type to get them.
    folder : Path
        For all but the page.
    page : Path
        An .html file.

    Raises
    ------
    OutputError
        Something cannot be written.
    """
    groups = grouped(results)
    write_tables(groups, command, folder / "tables.md")
    export(results, folder, parquet=True)
    figures = folder / "figures"
    parts = [Part("all sets", "", glances(groups), draw_all(groups, figures))]
    for group in groups:
        about = SETS[group.tasks].about if group.tasks in SETS else ""
        parts.append(Part(group.name, about, group_tables(group), draw_learning(group, figures)))
    write_page(page, parts, command, results)


def numbers(results: Sequence[Result]) -> dict[str, Any]:
    """Return interquartile means with their intervals, by set, agent and metric."""
    return {
        group.name: {
            agent: {key: spread_of(held, key)._asdict() for key in TOLD}
            for agent, held in group.agents.items()
        }
        for group in grouped(results)
    }
