"""Time other simulators of mobile robots beside ours, each in a virtual environment of its own.

    python scripts/measure_peers.py                          # install, measure, leave nothing
    python scripts/measure_peers.py --keep peers             # keep the environments for next time
    python scripts/measure_peers.py --doc docs/batch.md      # bring its table up to date, too

One environment, random actions, no rendering; simulated time by each simulator's own clock. Ours is
timed in turn with each peer, block by block, so that what else the machine does falls on both; a
ratio is the median over such pairs. A peer that cannot be installed or run is told as such.
"""

import json
import re
import signal
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
import tyro
from nomad_agents.checkpoint import write_atomically
from peer_environments import PEERS, Block, PeerError, install, running
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

from nomad_mj.errors import ConfigError

OURS = "nomad_mj"
_PLACE = re.compile(r"(<!-- peers -->\n)(.*?)(<!-- end -->)", re.DOTALL)
_COLUMNS = ("", "version", "steps/s", "simulated s/s", "ours, in turn", "ours / theirs")

Name = Literal["safety-gymnasium", "ir-sim", "point-maze"]


class Rates(NamedTuple):
    """Medians over blocks, and the versions of what ran."""

    simulated: float
    steps: float
    versions: dict[str, str]


class Comparison(NamedTuple):
    """A peer and ours, in turn; `ratio` is the median over pairs of blocks, ours / peer's."""

    peer: Rates
    ours: Rates
    ratio: float


Result = Comparison | PeerError


@dataclass(frozen=True)
class Options:
    """Time other simulators beside ours."""

    only: tuple[Name, ...] = ("safety-gymnasium", "ir-sim", "point-maze")
    """Which peers."""
    blocks: int = 9
    """How many blocks of each; the median counts."""
    seconds: float = 2.0
    """Length of a block."""
    keep: Path | None = None
    """Folder of environments to use, or to make and keep; a temporary one by default."""
    doc: Path | None = None
    """A page whose table is to be replaced."""
    json: bool = False
    """Print one line of JSON instead of the table."""


def rates(blocks: Sequence[Block], versions: dict[str, str]) -> Rates:
    """Return the medians of blocks."""
    simulated = float(np.median([b.simulated / b.seconds for b in blocks]))
    return Rates(simulated, float(np.median([b.steps / b.seconds for b in blocks])), versions)


def compare(
    pairs: Sequence[tuple[Block, Block]], versions: tuple[dict[str, str], dict[str, str]]
) -> Comparison:
    """Return what pairs of blocks, the peer's and ours, come to."""
    peer, ours = zip(*pairs, strict=True)
    quotients = [b.simulated / b.seconds * a.seconds / a.simulated for a, b in pairs]
    return Comparison(
        rates(peer, versions[0]), rates(ours, versions[1]), float(np.median(quotients))
    )


def measure(
    name: str, python: Path, folder: Path, options: Options, advance: Callable[[], None]
) -> Comparison:
    """Time a peer and ours in turn."""
    with (
        running(name, python, folder) as peer,
        running(OURS, Path(sys.executable), folder) as ours,
    ):
        versions = (peer.answer(), ours.answer())
        pairs: list[tuple[Block, Block]] = []
        for _ in range(options.blocks):
            pairs.append((peer.block(options.seconds), ours.block(options.seconds)))
            advance()
    return compare(pairs, versions)


def rows(results: Mapping[str, Result]) -> list[tuple[str, ...]]:
    """Return the table's lines, cell by cell; one of a peer that failed tells the reason."""
    lines: list[tuple[str, ...]] = []
    for name, found in results.items():
        what = f"{name}: {PEERS[name].what}"
        if isinstance(found, PeerError):
            lines.append((what, f"not measured: {found}", "", "", "", ""))
            continue
        version = ", ".join(f"{p} {v}" for p, v in found.peer.versions.items() if p != "python")
        numbers = (found.peer.steps, found.peer.simulated, found.ours.simulated, found.ratio)
        lines.append((what, version, *(f"{number:.3g}" for number in numbers)))
    return lines


def markdown(results: Mapping[str, Result]) -> str:
    """Return the table for a page, with the versions of ours below."""
    lines = [_COLUMNS, ("---",) * len(_COLUMNS), *rows(results)]
    text = "".join(f"| {' | '.join(cells)} |\n".replace("|  |", "| |") for cells in lines)
    measured = [r for r in results.values() if isinstance(r, Comparison)]
    if measured:
        ours = measured[0].ours
        versions = ", ".join(f"{package} {version}" for package, version in ours.versions.items())
        text += f"\nOurs ran with {versions}.\n"
    return text


def update(page: str, table: str) -> str:
    """Return a page with its table replaced; raise ConfigError if it has no place for one."""
    if not _PLACE.search(page):
        raise ConfigError(
            "has no lines <!-- peers --> and <!-- end --> for a table to stand between"
        )
    return _PLACE.sub(lambda place: place[1] + table + place[3], page)


def as_json(results: Mapping[str, Result]) -> dict[str, Any]:
    """Return all results, by peer, for a program."""
    found: dict[str, Any] = {}
    for name, result in results.items():
        if isinstance(result, PeerError):
            found[name] = {"error": str(result)}
            continue
        found[name] = {"ratio": result.ratio}
        for side, rate in (("peer", result.peer), ("ours", result.ours)):
            found[name][side] = {
                "simulated_s_per_s": rate.simulated,
                "steps_per_s": rate.steps,
                "versions": rate.versions,
            }
    return found


def measure_all(options: Options, console: Console) -> dict[str, Result]:
    """Install and time the peers, one after the other."""
    results: dict[str, Result] = {}
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="peers_")))
        progress = stack.enter_context(Progress(console=console, transient=True))
        for name in dict.fromkeys(options.only):
            task = progress.add_task(f"{name}: installing", total=None)
            try:
                python = install(PEERS[name], (options.keep or folder).absolute() / name)
                progress.update(task, description=f"{name}: timing", total=options.blocks)
                results[name] = measure(
                    name, python, folder, options, lambda task=task: progress.advance(task)
                )
            except PeerError as error:
                results[name] = error
            progress.remove_task(task)
    return results


def run(options: Options) -> None:
    """Measure, print and write."""
    if options.blocks < 1 or not 0 < options.seconds < 3600:
        raise ConfigError(
            f"blocks {options.blocks}, seconds {options.seconds:g}: must be at least 1, and above 0"
        )
    page = "" if options.doc is None else options.doc.read_text(encoding="utf-8")
    if options.doc is not None:
        update(page, "")  # before the long work
    results = measure_all(options, Console(stderr=True))
    if options.json:
        print(json.dumps(as_json(results)))
    else:
        table = Table(*_COLUMNS, title="One environment, random actions, no rendering")
        for cells in rows(results):
            table.add_row(*cells)
        Console().print(table)
    if options.doc is not None:
        text = update(page, markdown(results))
        write_atomically(options.doc, lambda file: file.write(text.encode()))


def _end(number: int, _: object) -> None:
    sys.exit(128 + number)


def main() -> None:
    """Run, and tell in one line what cannot be."""
    # An ordinary end, so that the temporary folder goes, and what was started with it.
    signal.signal(signal.SIGTERM, _end)
    try:
        run(tyro.cli(Options))
    except (ConfigError, OSError) as error:
        print(error, file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)


if __name__ == "__main__":
    main()
