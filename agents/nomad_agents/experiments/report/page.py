"""The page: sections become one HTML file that needs no network and no other file."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from nomad_agents.checkpoint import write_atomically
from nomad_agents.experiments.report.section import NoVideo, Section
from nomad_agents.studies.pages.embed import Picture, data_uri, picture
from nomad_agents.studies.pages.templates import find_template
from nomad_agents.studies.tables import without_empty_columns

_VERDICTS = {"holds": "holds", "holds in part": "part", "does not hold": "fails"}


class _Figure(NamedTuple):
    picture: Picture
    alt: str
    caption: str


class _Film(NamedTuple):
    uri: str
    poster: Picture
    caption: str
    file: str


class _Part(NamedTuple):
    """A section as the template takes it."""

    anchor: str
    section: Section
    mark: str
    reason: str
    headings: list[str]
    rows: list[list[str]]
    figures: list[_Figure]
    film: _Film | None
    no_film: str


def write_report(
    path: Path,
    sections: Sequence[Section],
    facts: Sequence[tuple[str, str]] = (),
    *,
    seeds: int = 0,
    introduced: bool = True,
) -> None:
    """Write the report, whole or not at all; the same sections give the same bits.

    Parameters
    ----------
    path : Path
        An .html file.
    sections : sequence of Section
        The experiments, in their order on the page.
    facts : sequence of (str, str)
        What is said at the end of how all was made, such as `provenance`.
    seeds : int
        Over how many seeds the numbers are; not said if 0.
    introduced : bool
        Whether the page begins with the paper's room and robot; numbers of others need no such.

    Raises
    ------
    OutputError
        A picture or video cannot be read, the page cannot be written.
    """
    parts = [
        _part(anchor, section, path.parent)
        for anchor, section in zip(_anchors(sections), sections, strict=True)
    ]
    counts = {mark: sum(part.mark == mark for part in parts) for mark in _VERDICTS.values()}
    text = find_template("page.html.jinja", "nomad_agents.experiments.report").render(
        parts=parts, facts=facts, seeds=seeds, counts=counts, introduced=introduced
    )
    write_atomically(path, lambda file: file.write(text.encode()))


def _anchors(sections: Sequence[Section]) -> Iterator[str]:
    """Yield an id for each section, its name as far as an id can have it."""
    used = {
        "reading",
        "summary",
        "tables",
        "making",
        "task-title",
        "task-text",
    }  # ids of the template
    for number, section in enumerate(sections, 1):
        word = re.sub(r"[^a-z0-9]+", "-", section.name.lower()).strip("-")
        word = word if word and word not in used else f"experiment-{number}"
        used.add(word)
        yield word


def _part(anchor: str, section: Section, folder: Path) -> _Part:
    headings, rows = without_empty_columns(section.table)
    figures = [
        _Figure(
            picture(Path(each.path)),
            f"{section.title}: figure {number} of {len(section.illustrations)}",
            each.caption,
        )
        for number, each in enumerate(section.illustrations, 1)
    ]
    video = section.video
    film = None
    if not isinstance(video, NoVideo):
        near = video.path.is_relative_to(folder)
        file = video.path.relative_to(folder).as_posix() if near else video.path.name
        film = _Film(data_uri(video.path), picture(video.poster), video.caption, file)
    no_film = video.reason if isinstance(video, NoVideo) else ""
    mark = _VERDICTS[section.verdict.holds]
    reason = _sentence(section.verdict.reason)
    return _Part(anchor, section, mark, reason, headings, rows, figures, film, no_film)


def _sentence(text: str) -> str:
    """Return words as a sentence: verdicts are written without, to stand in a line of output."""
    return f"{text[:1].upper()}{text[1:]}" + ("" if text.endswith((".", "!", "?")) else ".")
