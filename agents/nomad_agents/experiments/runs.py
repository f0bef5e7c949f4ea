"""Many runs of an experiment in parallel processes, each remembered in a file of its own.

A run that is on file is not done again: what was killed goes on where it was, to the same rows.
"""

import json
import multiprocessing
import re
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from nomad_agents.checkpoint import write_atomically
from nomad_mj.errors import OutputError

Row = dict[str, Any]


@dataclass(frozen=True)
class Run:
    """One run: what is done, by which agent and configuration, with which seed."""

    experiment: str
    agent: str
    config: str
    room: str
    robot: str
    seed: int

    @property
    def file_name(self) -> str:
        """Name of the file that holds its row."""
        parts = (self.experiment, self.agent, self.config, self.room, self.robot)
        words = [re.sub(r"[^A-Za-z0-9]+", "-", Path(part).stem) for part in parts]
        return f"{'_'.join(words)}_{self.seed:04d}.json"


def _key(run: Run) -> dict[str, Any]:
    """Return what a row must agree with to be this run's."""
    return {**asdict(run), "nomad_mj": version("nomad-mj"), "mujoco": version("mujoco")}


def stored_row(run: Run, folder: Path) -> Row | None:
    """Return the row of a run that is on file, None if there is none of this version.

    Raises
    ------
    OutputError
        The file is damaged.
    """
    path = folder / run.file_name
    if not path.exists():
        return None
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
        key, row = dict(held["run"]), dict(held["row"])
    except (OSError, ValueError, KeyError, TypeError):
        raise OutputError(f"{str(path)!r} is no row of an experiment: remove it") from None
    return row if key == _key(run) else None


def do_runs(
    runs: Sequence[Run],
    work: Callable[[Run], Row],
    folder: Path,
    jobs: int,
    after_run: Callable[[], None],
) -> list[Row]:
    """Return the rows of all runs, in their order, doing those that are not on file.

    Parameters
    ----------
    runs : sequence of Run
        What to do.
    work : callable
        Does a run in a process of its own; a function of a module.
    folder : Path
        Where rows are kept.
    jobs : int
        Number of processes.
    after_run : callable
        Called once for each run, when its row is there.
    """
    rows = {run: stored_row(run, folder) for run in runs}
    missing = [run for run, row in rows.items() if row is None]
    for _ in range(len(runs) - len(missing)):
        after_run()
    if missing:
        # Spawned, not forked: a process starts without what this one has done so far.
        context = multiprocessing.get_context("spawn")
        pool = ProcessPoolExecutor(min(jobs, len(missing)), mp_context=context)
        try:
            waiting = {pool.submit(work, run): run for run in missing}
            for future in as_completed(waiting):
                run = waiting[future]
                rows[run] = future.result()
                _store(run, rows[run] or {}, folder)
                after_run()
        finally:
            pool.shutdown(cancel_futures=True)
    return [row for row in rows.values() if row is not None]


def _store(run: Run, row: Row, folder: Path) -> None:
    text = json.dumps({"run": _key(run), "row": row}, indent=1).encode()
    write_atomically(folder / run.file_name, lambda file: file.write(text))
