"""Where the numbers of a report come from: seeds, versions, machines."""

from collections.abc import Sequence
from importlib.metadata import version

from nomad_agents.experiments.experiment import LEARNER, Study
from nomad_agents.studies.provenance import all_of
from nomad_agents.studies.runs import PACKAGES, Result

_HOUR = 3600.0  # [s]


def provenance(study: Study, results: Sequence[Result], wanted: int) -> list[tuple[str, str]]:
    """Return what a report says at its end: (term, description), the same for the same results.

    Parameters
    ----------
    study : Study
        What was asked for.
    results : sequence of Result
        Of all experiments, and of the trainings that they begin with.
    wanted : int
        How many runs the study is made of.
    """
    learners = sum(result.run.agent == LEARNER for result in results)
    seconds = sum(float(result.machine.get("cpu_s", 0.0)) for result in results)
    counts = f"{learners} of the learner, {len(results) - learners} of the baselines"
    if len(results) < wanted:
        counts += f", of {wanted} that were asked for"
    seeds = "0" if study.seeds == 1 else f"0 to {study.seeds - 1}"
    return [
        ("Parameters", study.config),
        ("Room, robot", f"{study.room}, {study.robot}"),
        ("Seeds", seeds),
        ("Runs", f"{counts}; {seconds / _HOUR:.1f} hours of computing"),
        ("Versions", ", ".join(f"{name} {version(name)}" for name in PACKAGES)),
        ("Python", all_of(results, "python")),
        ("Machine", all_of(results, "system")),
    ]
