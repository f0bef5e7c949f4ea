"""The figures of an experiment, chosen and drawn from its results alone; nothing is run."""

from collections.abc import Callable, Sequence
from itertools import chain
from pathlib import Path

from nomad_agents.experiments.experiment import Experiment
from nomad_agents.experiments.illustrate import numbers, rooms
from nomad_agents.experiments.illustrate.material import Illustration, Material
from nomad_agents.studies.runs import Result

__all__ = ["Illustration", "illustrate"]

_PAINTERS: dict[str, tuple[Callable[[Material], list[Illustration]], ...]] = {
    "fig6": (rooms.paths, numbers.learning),
    "fig7": (rooms.compare_planner,),
    "fig8": (rooms.actions, numbers.cases),
    "fig9": (rooms.actions, rooms.paths),
    "fig10": (rooms.actions, rooms.paths, numbers.learning),
    "fig11": (rooms.films,),
    "fig12": (rooms.films,),
    "fig13": (rooms.paths, numbers.learning),
    "fig14": (rooms.paths, numbers.learning),
    "noise": (numbers.cases,),
    "timing": (numbers.timing,),
    "robots": (rooms.fleet,),
    "ablations": (numbers.variants,),
}
_BEFORE = {"fig10": "fig9"}  # what an experiment's pictures are drawn beside


def illustrate(
    experiment: Experiment, results: Sequence[Result], folder: Path
) -> list[Illustration]:
    """Draw what an experiment's results hold.

    Parameters
    ----------
    experiment : Experiment
        Which.
    results : sequence of Result
        Of it. Those of others may be among them: the actions after adapting (fig10) are drawn
        beside those before (fig9).
    folder : Path
        Where the figures go.

    Returns
    -------
    list of Illustration
        None of what the results do not hold.

    Raises
    ------
    OutputError
        A figure cannot be written.
    """
    earlier = _BEFORE.get(experiment.name)
    material = Material(
        experiment,
        [result for result in results if result.run.experiment == experiment.name],
        [result for result in results if result.run.experiment == earlier],
        folder,
    )
    painters = _PAINTERS.get(experiment.name, ())
    return list(chain.from_iterable(paint(material) for paint in painters))
