"""All runs and all episodes as CSV, for whoever wants to count again."""

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from nomad_agents.checkpoint import write_atomically
from nomad_agents.studies.runs import PACKAGES, Result, Row, Run, version_of

_RUN = tuple(field.name for field in fields(Run))


def export(results: Sequence[Result], folder: Path, *, parquet: bool = False) -> tuple[Path, Path]:
    """Write ``runs.csv``, a row a run, and ``episodes.csv``, a row an episode.

    The rows' order depends on what the runs are, not on who came first. Numbers read back to the
    same bits; a cell is empty where a run has no such number.

    Parameters
    ----------
    results : sequence of Result
        Of any experiments.
    folder : Path
        Where to write them.
    parquet : bool
        Whether to write the same as ``runs.parquet`` and ``episodes.parquet`` too.

    Returns
    -------
    tuple of Path
        Both CSV files.

    Raises
    ------
    OutputError
        They cannot be written.
    """
    ordered = sorted(results, key=lambda result: tuple(asdict(result.run).values()))
    runs = [
        _joined({**asdict(result.run), **_versions(result.run), **result.machine}, result.row)
        for result in ordered
    ]
    episodes = [
        _joined({**asdict(result.run), "episode": number}, episode)
        for result in ordered
        for number, episode in enumerate(result.episodes)
    ]
    paths = folder / "runs.csv", folder / "episodes.csv"
    _write(runs, (*_RUN, *PACKAGES), paths[0])
    _write(episodes, (*_RUN, "episode"), paths[1])
    if parquet:
        for table, path in zip((runs, episodes), paths, strict=True):
            write_parquet(table, path.with_suffix(".parquet"))
    return paths


def write_parquet(rows: Sequence[Row], path: Path) -> None:
    """Write rows as Parquet, with all columns that any of them has.

    Raises
    ------
    OutputError
        The file cannot be written.
    """
    columns = dict.fromkeys(name for row in rows for name in row)
    table = pa.table({name: pa.array([row.get(name) for row in rows]) for name in columns})
    buffer = io.BytesIO()
    pq.write_table(table, buffer)
    write_atomically(path, lambda file: file.write(buffer.getvalue()))


def _joined(identity: Row, numbers: Row) -> Row:
    """Return both in one row; a number called like a column before it gets a longer name."""
    # NaN: it has none.
    held = {name: value if value == value else None for name, value in numbers.items()}
    return identity | {f"row_{k}" if k in identity else k: v for k, v in held.items()}


def _versions(run: Run) -> Row:
    return {name: version_of(name) for name in run.packages()}


def _write(rows: Sequence[Row], first: Sequence[str], path: Path) -> None:
    """Write rows with all columns that any of them has, in the order in which they appear."""
    columns = dict.fromkeys([*first, *(name for row in rows for name in row)])
    text = io.StringIO()
    writer = csv.DictWriter(text, list(columns), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    content = text.getvalue().encode()
    write_atomically(path, lambda file: file.write(content))
