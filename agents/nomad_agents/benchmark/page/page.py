"""Tables and figures become one HTML page, in the frame of the report's."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

from nomad_agents.checkpoint import write_atomically
from nomad_agents.studies.pages.embed import picture
from nomad_agents.studies.pages.templates import find_template
from nomad_agents.studies.provenance import all_of
from nomad_agents.studies.runs import PACKAGES, Result
from nomad_agents.studies.tables import TextTable, without_empty_columns

_HOUR = 3600.0  # [s]


class Figure(NamedTuple):
    """A figure, without a suffix, and what to say below it."""

    path: Path
    caption: str


@dataclass(frozen=True)
class Part:
    """A section of the page.

    Attributes
    ----------
    name, about : str
        Its heading, and a sentence.
    tables : sequence of TextTable
        First.
    figures : sequence of Figure
        Then.
    """

    name: str
    about: str
    tables: Sequence[TextTable]
    figures: Sequence[Figure] = field(default_factory=tuple[Figure, ...])


def write_page(path: Path, parts: Sequence[Part], command: str, results: Sequence[Result]) -> None:
    """Write the page, whole or not at all; the same results give the same bits.

    Parameters
    ----------
    path : Path
        An .html file.
    parts : sequence of Part
        The first is about all sets, the others about one each.
    command : str
        What to type to get it.
    results : sequence of Result
        For where the numbers come from.

    Raises
    ------
    OutputError
        A figure cannot be read, the page cannot be written.
    """
    template = find_template("benchmark.html.jinja", "nomad_agents.benchmark.page")
    text = template.render(
        parts=[_telling(part) for part in parts], command=command, facts=_facts(results)
    )
    write_atomically(path, lambda file: file.write(text.encode()))


def _telling(part: Part) -> dict[str, object]:
    """Return a section as the template takes it."""
    return {
        "anchor": "set-" + re.sub(r"[^a-z0-9]+", "-", part.name.lower()).strip("-"),
        "name": part.name,
        "about": part.about,
        "tables": [(table.title, *without_empty_columns(table)) for table in part.tables],
        "figures": [
            {
                "picture": picture(each.path.with_name(f"{each.path.name}.png")),
                "alt": f"{part.name}: {each.path.name}",
                "caption": each.caption,
            }
            for each in part.figures
        ],
    }


def _facts(results: Sequence[Result]) -> list[tuple[str, str]]:
    """Return where the numbers come from: (term, description)."""
    seconds = sum(float(result.machine.get("cpu_s", 0.0)) for result in results)
    seeds = sorted({result.run.seed for result in results})
    episodes = sum(len(result.episodes) for result in results)
    return [
        ("Robots", ", ".join(sorted({result.run.robot for result in results}))),
        ("Seeds", f"{seeds[0]} to {seeds[-1]}" if len(seeds) > 1 else str(seeds[0])),
        ("Runs", f"{len(results)}; {seconds / _HOUR:.1f} hours of computing"),
        ("Evaluated episodes", str(episodes)),
        ("Versions", ", ".join(f"{name} {version(name)}" for name in PACKAGES)),
        ("Python", all_of(results, "python")),
        ("Machine", all_of(results, "system")),
    ]
