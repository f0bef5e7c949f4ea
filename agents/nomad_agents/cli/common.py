"""What several commands share: names of options, environments, progress, output."""

import json
import math
import signal
import sys
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

from rich.console import Console

from nomad_agents.paths import expanded
from nomad_mj.errors import OutputError

_OF_FILES = (
    *(".npz", ".npy", ".pkl", ".pt", ".zip", ".csv", ".json", ".parquet", ".html", ".md", ".txt"),
    *(".xml", ".yaml", ".yml", ".mp4", ".avi", ".mov", ".gif", ".png", ".jpg", ".pdf"),
)


def console(*, json_wanted: bool) -> Console:
    """Return where people read: standard error if standard output is for a program."""
    return Console(stderr=json_wanted, highlight=False, markup=False)  # names may hold brackets


def print_json(values: Mapping[str, Any]) -> None:
    """Print one line of JSON; what is not a number becomes null."""
    print(json.dumps(_clean(values), allow_nan=False), flush=True)


def _clean(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _clean(inner) for key, inner in cast(Mapping[str, Any], value).items()}
    if isinstance(value, list | tuple):
        return [_clean(inner) for inner in cast(Sequence[Any], value)]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def output_file(out: str, default_name: str, suffix: str) -> Path:
    """Return the file that `--out` means: itself, or a file of `default_name` in that folder.

    Raises
    ------
    OutputError
        A name with another suffix, or a place that cannot be written.
    """
    path = expanded(out)
    try:
        is_folder = out.endswith("/") or path.is_dir()
        other = path.suffix.lower() in _OF_FILES and path.suffix != suffix
        if other and not is_folder:
            raise OutputError(f"--out {out!r}: this writes {suffix}; give such a file or a folder")
        if path.suffix != suffix or is_folder:
            path = path / f"{default_name}{suffix}"
        path.parent.mkdir(parents=True, exist_ok=True)
        probe = path.parent / f".{path.name}.writable"
        probe.touch()
        probe.unlink(missing_ok=True)  # another process may have been as quick
    except OSError as error:
        raise OutputError(f"cannot write {str(path)!r}: {error.strerror or error}") from None
    return path


@contextmanager
def interruptible() -> Generator[None, None, None]:
    """Let SIGTERM end the work as Ctrl-C does."""

    def interrupt(number: int, frame: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def fail(message: str) -> int:
    """Print one line of error; return the exit code of a user's mistake."""
    print(f"nomad-mj: {message}", file=sys.stderr)
    return 2
