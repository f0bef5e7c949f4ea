"""Progress bars."""

from collections import deque
from collections.abc import Callable, Generator, Iterable
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console, RenderableType
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text
from typing_extensions import Self

from nomad_agents.deep.training import DeepTraining
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.studies.runs import Result
from nomad_agents.training import Training

RECENT = 50  # episodes


class _CountedProgress(Progress):
    """A progress bar with a line of text below."""

    counts = ""

    def get_renderables(self) -> Iterable[RenderableType]:
        """Return the bar and the text."""
        yield from super().get_renderables()
        yield Text(self.counts, style="dim")


class _Shown:
    """Shows a progress bar while it is entered."""

    def __init__(self, progress: _CountedProgress) -> None:
        self._progress = progress

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()


class TrainingProgress(_Shown):
    """A bar over the starts of the present pass or test, with the counts of the training."""

    def __init__(self, screen: Console, starts: int) -> None:
        progress = _CountedProgress(
            TextColumn("{task.description}"),
            BarColumn(bar_width=30),
            MofNCompleteColumn(),
            TextColumn("{task.fields[solved]}"),
            TimeElapsedColumn(),
            console=screen,
        )
        super().__init__(progress)
        self._starts = starts
        self._task = self._progress.add_task("pass 1", total=starts, solved="")

    def show(self, training: Training, agent: ReactivePlanner) -> None:
        """Show how far the training is."""
        faster = training.sim_s / training.wall_s if training.wall_s > 0 else 0.0
        self._progress.counts = ", ".join(
            [
                f"{training.reactions} reactions",
                f"{training.plannings} plannings",
                f"{training.virtual_collisions} virtual collisions",
                f"{len(agent.network.category)} exemplars",
                f"{faster:.0f} x real time",
            ]
        )
        self._progress.update(
            self._task,
            description=f"{'test' if training.testing else 'pass'} {training.passes}",
            completed=training.next_start or self._starts,
            solved=f"solved {training.solved} of {training.tested}" if training.tested else "",
        )


class DeepProgress(_Shown):
    """A bar over the decisions of a deep training, with its counts."""

    def __init__(self, screen: Console, decisions: int) -> None:
        progress = _CountedProgress(
            TextColumn("{task.description}"),
            BarColumn(bar_width=30),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
            console=screen,
            speed_estimate_period=60,
        )
        super().__init__(progress)
        self._task = self._progress.add_task("decisions", total=decisions)
        self._episodes = 0
        self._ended = deque([0], maxlen=RECENT + 1)  # goals reached after each episode

    def show(self, training: DeepTraining) -> None:
        """Show how far the training is."""
        if training.episodes > self._episodes:
            self._episodes = training.episodes
            self._ended.append(training.reached)
        recent = len(self._ended) - 1
        self._progress.counts = ", ".join(
            [
                f"goal reached in {self._ended[-1] - self._ended[0]} of the last {recent} episodes",
                f"{training.virtual_collisions} virtual collisions",
                f"{training.sim_s / 3600:.1f} h simulated",
            ]
        )
        self._progress.update(self._task, completed=training.decisions)


def trial_progress(screen: Console) -> Progress:
    """Return a bar over episodes."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(bar_width=30),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=screen,
    )


def run_progress(screen: Console) -> Progress:
    """Return a bar over runs, with an estimate of what is left."""
    return Progress(
        TextColumn("{task.description:<9}"),
        BarColumn(bar_width=30),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
        console=screen,
        speed_estimate_period=300,  # runs differ in length
    )


@contextmanager
def counted_runs(
    screen: Console, total: int, folder: Path
) -> Generator[Callable[[Result], None], None, None]:
    """Show a bar over runs and yield what to call after each; interrupted, say what is kept.

    Parameters
    ----------
    screen : Console
        Where people read.
    total : int
        Number of runs.
    folder : Path
        Where their results are kept.
    """
    done = 0
    with run_progress(screen) as progress:
        task = progress.add_task("runs", total=total)

        def after_run(result: Result) -> None:
            nonlocal done
            done += 1
            progress.update(task, completed=done, description=result.run.experiment)

        try:
            yield after_run
        except KeyboardInterrupt:
            screen.print(
                f"{done} of {total} runs are on file in {folder}; the same command goes on from "
                "there, with --only-read it shows what there is",
                soft_wrap=True,
            )
            raise
