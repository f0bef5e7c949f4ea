"""What figures of an experiment are drawn from: its results, and the pictures that they hold."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from nomad_agents.experiments.experiment import LEARNER, Experiment
from nomad_agents.experiments.figures.room import Panel
from nomad_agents.studies.runs import Result
from nomad_mj.scene import build_scene


class Illustration(NamedTuple):
    """A figure: its path without ``.pdf`` and ``.png``, and what it shows."""

    path: Path
    caption: str


class Material(NamedTuple):
    """What figures are drawn from.

    Attributes
    ----------
    experiment, results
        Which, and its results.
    before : sequence of Result
        Those of the experiment that it is drawn beside, if any.
    folder : Path
        Where the figures go.
    """

    experiment: Experiment
    results: Sequence[Result]
    before: Sequence[Result]
    folder: Path

    def path(self, what: str) -> Path:
        """Return the path of a figure, without a suffix."""
        return self.folder / f"{self.experiment.name}_{what}"

    @property
    def cases(self) -> list[str]:
        """All cases, in the order of the runs."""
        return list(dict.fromkeys(result.run.case for result in self.results))


def holding(
    results: Sequence[Result], picture: str, agents: Sequence[str] = (LEARNER,)
) -> dict[tuple[str, str], Result]:
    """Return by case and agent the result of the lowest seed that holds such a picture."""
    held: dict[tuple[str, str], Result] = {}
    for result in sorted(results, key=lambda result: result.run.seed, reverse=True):
        if result.pictures.get(picture) and result.run.agent in agents:
            held[result.run.case, result.run.agent] = result
    places = [(r.run.case, r.run.agent) for r in results]
    return dict(sorted(held.items(), key=lambda item: places.index(item[0])))


def make_panel(result: Result, picture: str, title: str) -> Panel[Any]:
    """Return a picture in the room that it was taken in."""
    pictures, run = result.pictures, result.run
    scene = build_scene(pictures.get("room", run.room), run.robot, goal=pictures.get("goal"))
    return Panel(title, scene, pictures[picture])
