"""Many runs of experiments in parallel processes, each remembered in a file of its own.

A run that is on file is not done again: what was killed goes on where it was, to the same rows.
"""

import hashlib
import json
import multiprocessing
import os
import platform
import re
import signal
import threading
import time
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

import cattrs

from nomad_agents.checkpoint import write_atomically
from nomad_agents.registry import find_config
from nomad_mj.assets import find_robot, find_room
from nomad_mj.errors import OutputError, WorkerError

Row = dict[str, Any]
PACKAGES = ("nomad-mj", "mujoco", "numpy")


@dataclass(frozen=True)
class Run:
    """One run: what is done, in which case of it, by whom, where, with which seed.

    Attributes
    ----------
    experiment, case : str
        As on the command line, ``fig8``; which part of it, such as ``2 m``.
    agent, config, room, robot : str
        Names, or files of rooms and robots.
    seed : int
        Of all randomness.
    """

    experiment: str
    case: str
    agent: str
    config: str
    room: str
    robot: str
    seed: int

    @property
    def file_name(self) -> str:
        """Name of the file that holds its result."""
        places = (Path(self.room).stem, Path(self.robot).stem)
        parts = (self.experiment, self.case, self.agent, self.config, *places)
        words = [re.sub(r"[^A-Za-z0-9.]+", "-", part) for part in parts]
        return f"{'_'.join(words)}_{self.seed:04d}.json"

    def parameters(self) -> Row:
        """Return what the names of a run stand for, as data: a result of other values is stale.

        Raises
        ------
        NomadError
            A name that stands for nothing.
        """
        return cattrs.unstructure(find_config(self.config))


@dataclass
class Result:
    """What came of a run; JSON all the way down.

    Attributes
    ----------
    run : Run
        Which.
    row : dict
        The run's numbers by name; the same on every machine.
    episodes : list of dict
        The same of each episode.
    curve : list of dict
        While learning, one entry a pass.
    pictures : dict
        What figures are drawn from: see `pictures`.
    machine : dict
        Where and with what it was done, and how long it took; differs between machines.
    """

    run: Run
    row: Row
    episodes: list[Row] = field(default_factory=list[Row])
    curve: list[Row] = field(default_factory=list[Row])
    pictures: Row = field(default_factory=Row)
    machine: Row = field(default_factory=Row)


def _key(run: Run) -> Row:
    """Return what a file must agree with to be this run's: no stale numbers of another version."""
    key = {**asdict(run), "packages": {name: version(name) for name in PACKAGES}}
    key["parameters"] = run.parameters()
    key["files"] = [_digest(find_room(run.room)), _digest(find_robot(run.robot))]
    return json.loads(json.dumps(key))


def _digest(path: Path) -> str:
    """Return what tells a file's content from any other; what it includes is not looked at."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def stored_result(run: Run, folder: Path) -> Result | None:
    """Return the result of a run that is on file, None if there is none of this version.

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
        if held["key"] != _key(run):
            return None
        return Result(run, **{name: held[name] for name in _CONTENTS})
    except (OSError, ValueError, KeyError, TypeError):
        raise OutputError(f"{str(path)!r} is no result of an experiment: remove it") from None


_CONTENTS = ("row", "episodes", "curve", "pictures", "machine")


def _store(result: Result, folder: Path) -> None:
    held = {"key": _key(result.run), **{name: getattr(result, name) for name in _CONTENTS}}
    text = json.dumps(held, indent=1).encode()
    write_atomically(folder / result.run.file_name, lambda file: file.write(text))


def _obey() -> None:
    """Leave Ctrl-C to the process that holds the pool; go when it goes, even if it was killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_follow_parent, daemon=True).start()


def _follow_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)  # files are written whole or not at all: nothing is lost but this run


def _timed(work: Callable[[Run, Path], Result], run: Run, folder: Path) -> Result:
    began = time.perf_counter()
    result = work(run, folder)
    wall = round(time.perf_counter() - began, 3)
    result.machine |= {"system": platform.platform(), "processor": platform.machine()}
    result.machine |= {"python": platform.python_version(), "wall_s": wall}
    _store(result, folder)
    return result


def do_runs(
    runs: Sequence[Run],
    work: Callable[[Run, Path], Result],
    folder: Path,
    jobs: int,
    after_run: Callable[[Result], None],
) -> list[Result]:
    """Return the results of all runs, in their order, doing those that are not on file.

    Parameters
    ----------
    runs : sequence of Run
        What to do.
    work : callable
        Does a run in a process of its own, given the folder too; a function of a module.
    folder : Path
        Where results are kept.
    jobs : int
        Number of processes.
    after_run : callable
        Called once for each run, when its result is there.

    Raises
    ------
    WorkerError
        A process was killed.
    NomadError
        What a run raised; the results of those before it are kept.
    """
    results = {run: stored_result(run, folder) for run in runs}
    for result in results.values():
        if result is not None:
            after_run(result)
    missing = [run for run, result in results.items() if result is None]
    if missing:
        with closing(_do(missing, work, folder, jobs)) as done:
            for result in done:
                results[result.run] = result
                after_run(result)
    return [result for result in results.values() if result is not None]


def _do(
    runs: Sequence[Run], work: Callable[[Run, Path], Result], folder: Path, jobs: int
) -> Generator[Result, None, None]:
    """Yield the results of runs as they come; whatever ends this ends the processes."""
    # Spawned, not forked: a process starts without what this one has done so far.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(min(jobs, len(runs)), mp_context=context, initializer=_obey)
    try:
        waiting = [pool.submit(_timed, work, run, folder) for run in runs]
        for future in as_completed(waiting):
            yield future.result()
    except BrokenProcessPool:
        raise WorkerError(
            "a process was killed, perhaps for want of memory; what is done is kept: take "
            "fewer --jobs and run again"
        ) from None
    except BaseException:
        for process in multiprocessing.active_children():
            process.terminate()  # nobody who interrupts wants to wait for the present runs
        raise
    finally:
        pool.shutdown(cancel_futures=True)
