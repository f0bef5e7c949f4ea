"""A small report that tests of it share."""

from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from matplotlib.figure import Figure
from nomad_agents.experiments.experiment import Verdict
from nomad_agents.experiments.report import NoVideo, Section
from nomad_agents.studies.tables import TextTable


class Picture(NamedTuple):
    path: Path
    caption: str


def make_section(folder: Path) -> Section:
    """Return a section with a table, a figure as PNG and PDF, and no video."""
    figure = Figure((4, 3))
    figure.add_subplot().plot([0, 1, 0])
    for suffix in ("png", "pdf"):
        figure.savefig(folder / f"a.{suffix}", dpi=160)
    table = TextTable(
        "learning",
        ("", "paper", "ours: median [quartiles]", "ours: IQM (95 %)", "planner at every decision"),
        (
            ("seeds that solve all starts", "1 of 1", "20 of 20", "", ""),
            ("reactions while learning", "1424", "760 [723, 786]", "", "1000.0 [1000.0, 1000.0]"),
        ),
    )
    pictures = [Picture(folder / "a.png", "A line."), Picture(folder / "a.pdf", "It again.")]
    return Section(
        "fig6",
        "Learning",
        "It learns.",
        "Section 4",
        Verdict("holds", "All do."),
        table,
        pictures,
        NoVideo("no OpenGL works here"),
        "nomad-mj reproduce fig6 --seeds 20",
    )


def three(section: Section, *others: Section) -> list[Section]:
    """Return sections of all three verdicts, and others."""
    part = replace(section, name="fig9", verdict=Verdict("holds in part", "Some do."))
    return [
        section,
        part,
        replace(part, name="fig13", verdict=Verdict("does not hold", "none does")),
        *others,
    ]
