"""Do a study: the runs of some experiments, trained agents first, in one pool of processes."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from nomad_agents.experiments.experiment import Experiment, Study
from nomad_agents.experiments.learnt import TRAINING, forget_lost, train_room, training_run
from nomad_agents.experiments.paper import EXPERIMENTS
from nomad_agents.studies.runs import Result, Run, do_runs, stored_result

Results = dict[str, list[Result]]


def work(run: Run, folder: Path) -> Result:
    """Do one run of any experiment; called in a process of its own."""
    if run.experiment == TRAINING:
        return train_room(run, folder)
    return EXPERIMENTS[run.experiment].work(run, folder)


def trainings(experiments: Sequence[Experiment], study: Study) -> list[Run]:
    """Return the runs in which the agents learn that the experiments begin with."""
    runs: list[Run] = []
    for each in experiments:
        own = each.runs(study)
        runs += own if each.needs_trained else own[: each.shows_trained]
    return list(dict.fromkeys(training_run(run) for run in runs))


def count_runs(experiments: Sequence[Experiment], study: Study) -> int:
    """Return how many runs a study is made of."""
    return len(trainings(experiments, study)) + sum(len(e.runs(study)) for e in experiments)


def reproduce(
    experiments: Sequence[Experiment],
    study: Study,
    folder: Path,
    jobs: int,
    after_run: Callable[[Result], None],
) -> Results:
    """Return the results of experiments by name, doing the runs that are not on file.

    Those of the trainings that they begin with are among them, under `TRAINING`.

    Parameters
    ----------
    experiments, study
        What to do.
    folder : Path
        Where results are kept, one file a run.
    jobs : int
        Number of processes.
    after_run : callable
        Called once for each run, when its result is there.
    """
    lessons = trainings(experiments, study)
    for run in lessons:
        forget_lost(run, folder)
    learnt = do_runs(lessons, work, folder, jobs, after_run)
    # Seed by seed: whoever stops early has all experiments, over fewer seeds.
    runs = sorted(_runs(experiments, study), key=lambda run: run.seed)
    done = do_runs(runs, work, folder, jobs, after_run)
    return _by_name(experiments, study, {result.run: result for result in [*learnt, *done]})


def on_file(experiments: Sequence[Experiment], study: Study, folder: Path) -> Results:
    """Return the results that are on file, and do nothing."""
    every = [*trainings(experiments, study), *_runs(experiments, study)]
    held = {run: stored_result(run, folder) for run in every}
    return _by_name(experiments, study, held)


def _runs(experiments: Sequence[Experiment], study: Study) -> list[Run]:
    return [run for each in experiments for run in each.runs(study)]


def _by_name(
    experiments: Sequence[Experiment], study: Study, results: Mapping[Run, Result | None]
) -> Results:
    """Return the results that there are, in the order of the experiments' runs."""
    wanted = {each.name: each.runs(study) for each in experiments}
    wanted[TRAINING] = trainings(experiments, study)
    return {
        name: [held for run in runs if (held := results[run]) is not None]
        for name, runs in wanted.items()
    }
