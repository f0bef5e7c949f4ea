"""What the report is made of, as plain data."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from nomad_agents.experiments.experiment import Verdict
from nomad_agents.studies.tables import TextTable


class Captioned(Protocol):
    """A picture and what to say below it."""

    @property
    def path(self) -> Path:
        """A .png, .jpg or .svg file; of a .pdf the .png beside it is shown."""
        ...

    @property
    def caption(self) -> str:
        """Sentences."""
        ...


@dataclass(frozen=True)
class Video:
    """A video, H.264 in an MP4 file, the picture (JPEG) that stands for it, and a caption."""

    path: Path
    poster: Path
    caption: str


@dataclass(frozen=True)
class NoVideo:
    """Why there is no video, in a sentence."""

    reason: str


@dataclass(frozen=True)
class Section:
    """What the report says of one experiment.

    Attributes
    ----------
    name, title, claim, source
        As of `Experiment`.
    verdict : Verdict
        Whether the claim holds, and why.
    table : TextTable
        The numbers.
    illustrations : sequence of Captioned
        The figures.
    video : Video or NoVideo
        The video, or why there is none.
    command : str
        What to type to get all this.
    """

    name: str
    title: str
    claim: str
    source: str
    verdict: Verdict
    table: TextTable
    illustrations: Sequence[Captioned]
    video: Video | NoVideo
    command: str
