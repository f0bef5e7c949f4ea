"""Progress bars."""

from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from typing_extensions import Self

from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.training import Training


class TrainingProgress:
    """A bar over the starts of the present pass or test, with the counts of the training."""

    def __init__(self, screen: Console, starts: int) -> None:
        self._starts = starts
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(bar_width=18),
            MofNCompleteColumn(),
            TextColumn("{task.fields[counts]}"),
            TimeElapsedColumn(),
            console=screen,
        )
        self._task = self._progress.add_task("pass 1", total=starts, counts="")

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._progress.stop()

    def show(self, training: Training, agent: ReactivePlanner) -> None:
        """Show how far the training is."""
        tested = training.testing or training.tested == self._starts
        faster = training.sim_s / training.wall_s if training.wall_s > 0 else 0.0
        counts = [
            f"solved {training.solved}/{self._starts}" if tested else "",
            f"{training.reactions} reactions",
            f"{training.plannings} plannings",
            f"{training.virtual_collisions} virtual collisions",
            f"{len(agent.network.category)} exemplars",
            f"{faster:.0f}x real time",
        ]
        phase = "test" if training.testing else "pass"
        self._progress.update(
            self._task,
            description=f"{phase} {training.passes}",
            completed=training.next_start or self._starts,
            counts=", ".join(filter(None, counts)),
        )


def trial_progress(screen: Console) -> Progress:
    """Return a bar over episodes."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(bar_width=30),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=screen,
    )
