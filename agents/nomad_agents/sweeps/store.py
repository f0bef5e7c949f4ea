"""The results of a sweep on file: one Parquet file, and a journal of what is not yet in it.

A result is a line of the journal as soon as it is there. From time to time all lines go into the
Parquet file, which is written anew beside the old one, flushed to the disk and renamed; only then
is the journal emptied. Whatever ends this in between, a result is in one of them, or in both; read
back it counts once. A last line without its end was being written, and its run is done again.
"""

import fcntl
import json
import os
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from nomad_agents.checkpoint import write_atomically
from nomad_agents.studies.runs import Row
from nomad_agents.sweeps.grid import Cell, Grid, SweepRun, as_data, from_data
from nomad_mj.errors import ConfigError, OutputError

TABLE = "sweep.parquet"
_JOURNAL = "sweep.journal"
_LOCK = "sweep.lock"
_ABOUT = b"nomad_mj.sweep"
_OFTEN = 200  # lines of the journal, or a tenth of the table if that is more
SEED = "seed"


@contextmanager
def locked(folder: Path) -> Generator[None, None, None]:
    """Keep other sweeps out of a folder; a lock of a process that has gone does not.

    Raises
    ------
    OutputError
        A sweep is at work there, or the folder cannot be written.
    """
    path = folder / _LOCK
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = path.open("a+", encoding="utf-8")
    except OSError as error:
        raise OutputError(f"cannot write {str(path)!r}: {error.strerror or error}") from None
    with file:
        try:
            # The system lets go of it whenever this process ends, however that is.
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            raise OutputError(
                f"{str(folder)!r} is in use by another sweep, process {file.read().strip()}; wait "
                "for it, or take another --out"
            ) from None
        except OSError as error:
            raise OutputError(f"cannot lock {str(path)!r}: {error.strerror or error}") from None
        file.truncate(0)
        file.write(f"{os.getpid()} of {os.uname().nodename}")
        file.flush()
        try:
            yield
        finally:
            file.truncate(0)


class Store:
    """What a folder holds of a sweep.

    Attributes
    ----------
    grid : Grid
        All that is to be done.
    rows : dict of SweepRun to dict
        What is done, in no order.
    sources : dict
        What else the numbers depend on; see `work.sources`.
    """

    def __init__(self, folder: Path, grid: Grid, sources: Row, rows: dict[SweepRun, Row]) -> None:
        self.grid, self.rows = grid, rows
        self.sources = sources
        self._folder = folder
        self._lines = 0

    def missing(self) -> list[SweepRun]:
        """Return the runs that are not done, in their order."""
        return [run for run in self.grid.runs() if run not in self.rows]

    def runs_of(self, cell: Cell) -> list[SweepRun]:
        """Return the runs of a combination that are done."""
        every = (SweepRun(cell, seed) for seed in range(self.grid.seeds))
        return [run for run in every if run in self.rows]

    def add(self, run: SweepRun, row: Row) -> None:
        """Keep the result of a run; OutputError if it cannot be written."""
        line = json.dumps({"cell": run.cell, SEED: run.seed, "row": row}) + "\n"
        path = self._folder / _JOURNAL
        content = line.encode()
        try:
            with path.open("ab", buffering=0) as journal:
                if journal.write(content) != len(content):
                    raise OSError(None, "the disk is full")
        except OSError as error:
            raise OutputError(f"cannot write {str(path)!r}: {error.strerror or error}") from None
        self.rows[run] = row
        self._lines += 1
        if self._lines >= max(_OFTEN, len(self.rows) // 10):
            self.fold()

    def fold(self) -> None:
        """Write all that is done into the Parquet file and empty the journal.

        Raises
        ------
        OutputError
            It cannot be written; the old file and the journal are kept.
        """
        about = json.dumps({"grid": as_data(self.grid), "sources": self.sources})
        table = as_table(self.grid, self.rows).replace_schema_metadata({_ABOUT: about})
        write_atomically(self._folder / TABLE, lambda file: pq.write_table(table, file))
        (self._folder / _JOURNAL).unlink(missing_ok=True)
        self._lines = 0


def as_table(grid: Grid, rows: Mapping[SweepRun, Row]) -> Any:
    """Return the `pyarrow.Table` of a sweep: a row a run, in the order of the runs.

    Columns: the options, the seed, then all numbers in the order in which the first run that has
    them tells them; null where a run has none.
    """
    runs = [run for run in grid.runs() if run in rows]
    names = dict.fromkeys(name for run in runs for name in rows[run])
    # Agents that learn have more to tell; versions and machine stay last all the same.
    ordered = sorted(names, key=lambda name: name.startswith(("version_", "machine_")))
    cells = [dict(run.cell) for run in runs]
    columns: dict[str, Any] = {
        name: pa.array([cell[name] for cell in cells], pa.array(values[:1]).type)
        for name, values in grid.axes
    }
    columns[SEED] = pa.array([run.seed for run in runs], pa.int64())
    for name in ordered:
        columns[name] = pa.array([rows[run].get(name) for run in runs])
    return pa.table(columns)


def _is_there(path: Path) -> bool:
    try:
        return path.exists()
    except OSError as error:  # a folder that may not be entered
        raise OutputError(f"cannot read {str(path)!r}: {error.strerror}") from None


def read_store(folder: Path) -> Store | None:
    """Return what a folder holds, None if that is nothing.

    Raises
    ------
    OutputError
        A file of it is damaged or of something else.
    """
    path, journal = folder / TABLE, folder / _JOURNAL
    if not _is_there(path):
        if _is_there(journal) and journal.stat().st_size:
            raise OutputError(
                f"{str(journal)!r} holds results of a sweep whose {TABLE} is not there: put that "
                "back, or remove both"
            )
        return None
    journalled = _journalled(journal)  # first: a sweep at work may empty it by now
    try:
        table = pq.read_table(path)
        about = json.loads(table.schema.metadata[_ABOUT])
        grid = from_data(about["grid"])
        store = Store(folder, grid, about["sources"], _rows(table, grid))
    except (OSError, pa.ArrowException, KeyError, TypeError, ValueError):
        raise OutputError(f"{str(path)!r} is damaged or no table of a sweep: move it") from None
    store.rows |= journalled
    return store


def _rows(table: Any, grid: Grid) -> dict[SweepRun, Row]:
    names = [name for name, _ in grid.axes]
    found: dict[SweepRun, Row] = {}
    for held in table.to_pylist():
        cell = tuple((name, held.pop(name)) for name in names)
        run = SweepRun(cell, held.pop(SEED))
        found[run] = {name: value for name, value in held.items() if value is not None}
    return found


def _journalled(path: Path) -> dict[SweepRun, Row]:
    """Return the results of the journal; a last line without its end is cut off."""
    if not path.exists():
        return {}
    content = path.read_bytes()
    whole = content[: content.rfind(b"\n") + 1]
    read = (_parsed(line, number, path) for number, line in enumerate(whole.splitlines(), 1))
    return dict(read)


def _parsed(line: bytes, number: int, path: Path) -> tuple[SweepRun, Row]:
    try:
        held = json.loads(line)
        cell = tuple((str(name), value) for name, value in held["cell"])
        return SweepRun(cell, int(held[SEED])), dict(held["row"])
    except (ValueError, KeyError, TypeError):
        raise OutputError(f"{str(path)!r}, line {number} is damaged: remove that line") from None


def open_store(folder: Path, grid: Grid, sources: Row) -> Store:
    """Return the store of a grid in a folder, with what is done of it; to be held `locked`.

    Seeds and values can be more than they were. Nothing is written before `Store.fold`.

    Raises
    ------
    ConfigError
        The folder holds another sweep.
    OutputError
        It holds something damaged.
    """
    held = read_store(folder)
    if held is not None and held.rows:
        _refuse_other(folder, held, grid, sources)
        grid = _joined(held.grid, grid)
    for left in folder.glob(f".{TABLE}.*"):
        left.unlink(missing_ok=True)  # of a process that was killed while it wrote
    return Store(folder, grid, sources, held.rows if held else {})


def _refuse_other(folder: Path, held: Store, grid: Grid, sources: Row) -> None:
    mine, theirs = ([name for name, _ in each.axes] for each in (grid, held.grid))
    if sorted(mine) != sorted(theirs):
        raise ConfigError(
            f"{str(folder)!r} holds a sweep of other options: {', '.join(theirs)}, not "
            f"{', '.join(mine)}; take another --out"
        )
    now = dict(grid.axes)
    for name, values in held.grid.axes:
        if gone := [str(value) for value in values if value not in now[name]]:
            raise ConfigError(
                f"{str(folder)!r} holds a sweep with {name}={','.join(gone)} too, which is not "
                "asked for; add it, or take another --out"
            )
    for kind, known in held.sources.items():
        for name, value in known.items():
            if sources[kind].get(name, value) != value:
                raise ConfigError(
                    f"{str(folder)!r} holds a sweep with another {name}; take another --out"
                )


def _joined(held: Grid, grid: Grid) -> Grid:
    """Return the grid with the seeds of both, its options in the order in which they are held."""
    values = dict(grid.axes)
    axes = tuple((name, values[name]) for name, _ in held.axes)
    return Grid(axes, max(held.seeds, grid.seeds))
