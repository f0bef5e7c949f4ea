"""Many runs of experiments in parallel processes, each remembered in a file of its own.

A run that is on file is not done again: what was killed goes on where it was, to the same rows.
"""

import json
import platform
import re
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, field
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import cattrs

from nomad_agents.checkpoint import write_atomically
from nomad_agents.registry import find_config
from nomad_agents.studies.digest import digests
from nomad_agents.studies.pool import do_in_processes
from nomad_mj.assets import find_robot, find_room
from nomad_mj.errors import OutputError

Row = dict[str, Any]
PACKAGES = ("nomad-mj", "mujoco", "numpy")
_EDITION = 3  # one more whenever the same run comes to count or measure otherwise


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

    def packages(self) -> tuple[str, ...]:
        """Return whose versions its numbers depend on."""
        return PACKAGES

    def rooms(self) -> tuple[str, ...]:
        """Return the rooms that it is done in: its own, and any others."""
        return (self.room,)

    def identity(self) -> Row:
        """Return what tells it from other runs, wherever its files lie."""
        own = {"room": find_room(self.room).stem, "robot": find_robot(self.robot).stem}
        return asdict(self) | own


@dataclass
class Result:
    """What came of a run; JSON all the way down.

    Attributes
    ----------
    run : Run
        Which.
    row : dict
        The run's numbers by name; the same on every machine, but for what its processor rounds.
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


def version_of(package: str) -> str | None:
    """Return the version of a package that is installed, None if it is not."""
    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _key(run: Run) -> Row:
    """Return what a file must agree with to be this run's: no stale numbers of another version."""
    key = {**run.identity(), "edition": _EDITION}
    key["packages"] = {name: version_of(name) for name in run.packages()}
    key["parameters"] = run.parameters()
    key["files"] = digests(run.robot, *run.rooms())
    return json.loads(json.dumps(key))


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
        key, made_with = _key(run), held["key"]["packages"]
        # What is not installed here, whoever reads needs not.
        missing = {name: made_with[name] for name, here in key["packages"].items() if here is None}
        key["packages"] |= missing
        if held["key"] != key:
            return None
        result = Result(run, **{name: held[name] for name in _CONTENTS})
        result.machine |= missing
        return result
    except (OSError, ValueError, KeyError, TypeError):
        raise OutputError(f"{str(path)!r} is no result of an experiment: remove it") from None


_CONTENTS = ("row", "episodes", "curve", "pictures", "machine")


def _store(result: Result, key: Row, folder: Path) -> None:
    held = {"key": key, **{name: getattr(result, name) for name in _CONTENTS}}
    text = json.dumps(held, indent=1).encode()
    write_atomically(folder / result.run.file_name, lambda file: file.write(text))


class Stopwatch:
    """Measures a run in a process of its own: by the clock, and what this process computed."""

    def __init__(self) -> None:
        self._wall, self._cpu = time.perf_counter(), time.process_time()

    def read(self) -> Row:
        """Return the seconds since it was made: ``wall_s``; ``cpu_s``, of all cores together."""
        return {
            "wall_s": round(time.perf_counter() - self._wall, 3),
            "cpu_s": round(time.process_time() - self._cpu, 3),
        }


def describe_machine(stopwatch: Stopwatch) -> Row:
    """Return where and with what a run was done, and how long it took [s]."""
    return {
        "system": platform.platform(),
        "processor": platform.machine(),
        "python": platform.python_version(),
        **stopwatch.read(),
    }


def _timed(work: Callable[[Run, Path], Result], folder: Path, run: Run) -> Result:
    stopwatch, key = Stopwatch(), _key(run)  # of the files as they are when it begins
    result = work(run, folder)
    result.machine |= describe_machine(stopwatch)
    _store(result, key, folder)
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
        A run has killed its process again and again; the others are done.
    NomadError
        What a run raised; the results of those before it are kept.
    """
    results = {run: stored_result(run, folder) for run in runs}
    for result in results.values():
        if result is not None:
            after_run(result)
    missing = [run for run, result in results.items() if result is None]
    if missing:
        doing = do_in_processes(partial(_timed, work, folder), missing, jobs)
        with closing(doing) as done:
            for run, result in done:
                results[run] = result
                after_run(result)
    return [result for result in results.values() if result is not None]
