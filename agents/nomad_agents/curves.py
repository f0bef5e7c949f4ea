"""Curves of a training for TensorBoard, by decisions; no TensorFlow, no PyTorch."""

from collections.abc import Generator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType
from typing import Any

from typing_extensions import Self

from nomad_agents.episode import Turn
from nomad_agents.extras import need
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.training import Training
from nomad_mj.errors import OutputError

_FILES = "events.out.tfevents.*"
_WHAT = "TensorBoard's curves"
_EVENTS = "tensorboard.backend.event_processing.event_accumulator"


class Curves:
    """Writes what a training of the reactive planner comes to, after each episode.

    A training that is killed and resumed does its last episodes again, to the same bits: what the
    folder holds already is not written twice.

    Parameters
    ----------
    folder : str or Path
        Of this run alone.
    resume : bool
        Go on with the curves there; else those of a training before are deleted.

    Raises
    ------
    ConfigError
        TensorBoard is not installed.
    OutputError
        The folder cannot be written.
    """

    def __init__(self, folder: str | Path, *, resume: bool = False) -> None:
        summary = need("tensorboard.summary", "tensorboard", _WHAT)
        with curves_folder(Path(folder), resume=resume) as path:
            self._last = {tag: points[-1][0] for tag, points in read_curves(path).items()}
            self._writer: Any = summary.Writer(str(path))
            self._folder = path
        self._reward = 0.0
        self._before = Training()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        with suppress(OSError):  # what failed before fails again, and has been told
            self._writer.close()

    def begin(self, training: Training) -> None:
        """Say how far the training is before its next episode."""
        self._before = Training(**vars(training))

    def watch(self, turn: Turn) -> None:
        """Add up the reward of a learning episode."""
        if turn.after is not None:
            self._reward += float(turn.after.reward)

    def add(self, training: Training, agent: ReactivePlanner) -> None:
        """Write what the episode that has just ended came to: one of learning, or the last test.

        Parameters
        ----------
        training : Training
            How far the training is now.
        agent : ReactivePlanner
            What it has learnt.
        """
        before, step = self._before, training.decisions
        length = step - before.decisions
        if length:
            self._write("episode/decisions", length, step)
            self._write("episode/reward", self._reward, step)
            for name in ("reactions", "plannings", "virtual_collisions", "bumper_contacts"):
                self._write(f"learning/{name}", getattr(training, name), step)
            self._write("learnt/categories", len(agent.network.value), step)
            self._write("learnt/exemplars", len(agent.network.category), step)
        if before.testing and training.next_start == 0:
            self._write("test/solved_starts", training.solved, step)
        self._reward = 0.0
        self.begin(training)

    def flush(self) -> None:
        """Put on disk what was written, as is done before a checkpoint: none is ahead of them.

        Raises
        ------
        OutputError
            They cannot be written.
        """
        with _told(self._folder):
            self._writer.flush()

    def _write(self, tag: str, value: float, step: int) -> None:
        if step > self._last.get(tag, -1):
            with _told(self._folder):
                self._writer.add_scalar(tag, value, step)


def has_curves(folder: Path) -> bool:
    """Return whether there are curves of a run in its folder."""
    return any(folder.glob(_FILES))


@contextmanager
def curves_folder(folder: Path, *, resume: bool) -> Generator[Path, None, None]:
    """Make the folder of a run's curves, for a writer to be opened in; see `Curves`."""
    with _told(folder):
        folder = folder.expanduser()
        folder.mkdir(parents=True, exist_ok=True)
        if not resume:
            for file in folder.glob(_FILES):
                file.unlink()
        yield folder


@contextmanager
def _told(folder: Path) -> Generator[None, None, None]:
    """Let errors of the disk be told in a line."""
    try:
        yield
    except (OSError, RuntimeError) as error:  # RuntimeError: a home that there is not
        reason = getattr(error, "strerror", None) or error
        raise OutputError(f"cannot write curves to {str(folder)!r}: {reason}") from None


def read_curves(folder: Path) -> dict[str, list[tuple[int, float]]]:
    """Return the points (decisions, value) of each curve in a folder of TensorBoard's."""
    events = need(_EVENTS, "tensorboard", _WHAT)
    tensors = need("tensorboard.util.tensor_util", "tensorboard", _WHAT)
    if not any(folder.glob(_FILES)):
        return {}
    every = {"tensors": 0, "scalars": 0}
    found = events.EventAccumulator(str(folder), size_guidance=every).Reload()
    return {
        tag: [
            (int(e.step), float(tensors.make_ndarray(e.tensor_proto))) for e in found.Tensors(tag)
        ]
        for tag in found.Tags()["tensors"]
    }
