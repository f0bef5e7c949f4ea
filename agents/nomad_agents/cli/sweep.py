"""``nomad-mj sweep``."""

import shlex
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

import tyro
from rich.console import Console

from nomad_agents.checkpoint import write_atomically
from nomad_agents.cli.common import console, interruptible, output_file, print_json
from nomad_agents.cli.progress import run_progress
from nomad_agents.paths import expanded
from nomad_agents.studies.pool import do_in_processes
from nomad_agents.studies.runs import Row
from nomad_agents.studies.statistics import spread
from nomad_agents.studies.tables import as_markdown, as_rich
from nomad_agents.sweeps.grid import SweepRun, describe, read_grid
from nomad_agents.sweeps.ray_pool import do_on_ray, has_ray
from nomad_agents.sweeps.store import TABLE, Store, locked, open_store, read_store
from nomad_agents.sweeps.summary import choose_metrics, column, draw, make_summary
from nomad_agents.sweeps.work import check_grid, do_run, require_extras, sources
from nomad_mj.errors import ConfigError, OutputError

_Pool = Callable[[partial[Row], Sequence[SweepRun]], Generator[tuple[SweepRun, Row], None, None]]


@dataclass(frozen=True)
class Sweep:
    """Train and evaluate agents under every combination of some options, over seeds.

    Options: option=value,value,... for the agent, any option of train and evaluate and any
    parameter of an agent, such as agent=reactive_planner,sac,vfh,dwa room=paper_room,clutter
    range_noise=0.05,0.3 k_ind=0.02,0.1 decisions=4000 sac.learning_rate=0.001 vfh.safety=0.1,0.2.
    An agent's own options make combinations for it alone. The same command goes on where it was
    stopped; more seeds and values may be added.
    """

    options: Annotated[tuple[str, ...], tyro.conf.Positional] = ()
    """What to sweep, one word an option."""
    grid: str = ""
    """YAML file of options and lists of their values; words add to it."""
    seeds: int = 5
    """Every combination is run with the seeds 0, 1, ..."""
    starts: str = "50"
    """Number of unseen starts to evaluate from, or a file of lines x,y[,heading], metres and
    radians."""
    jobs: int = 2
    """Runs at once on this machine."""
    backend: Literal["auto", "ray", "processes"] = "auto"
    """What does the runs: Ray if it is installed, or plain processes of this machine."""
    address: str = ""
    """Ray cluster to do them on: auto, or HOST:PORT."""
    metric: tuple[str, ...] = ()
    """Numbers to show, columns of sweep.parquet; if none: success_rate, spl, learn_reactions."""
    out: str = "renders/sweep"
    """Folder for sweep.parquet, the table and the figures; one sweep a folder."""
    only_read: bool = False
    """Run nothing: show all that is on file in --out, and draw it."""
    json: bool = False
    """Print one line of JSON last on standard output."""

    def run(self) -> int:
        """Run what is missing, then show the table and draw the figures."""
        screen = console(json_wanted=self.json)
        folder = expanded(self.out)
        self._check()
        with interruptible():
            store = self._read(folder) if self.only_read else self._sweep(folder, screen)
            self._show(store, folder, screen)
        return 0

    def _check(self) -> None:
        """Refuse what would be ignored, or be found out about after all the work."""
        for name in self.metric:
            if "=" in name:
                raise ConfigError(f"sweep: {name!r} follows --metric: options come before it")
        works = ("options", "grid", "seeds", "starts", "jobs", "backend", "address")
        if self.only_read and any(getattr(self, each) != getattr(Sweep, each) for each in works):
            raise ConfigError(
                "sweep: --only-read shows all there is in --out; beside that it takes --metric "
                "and --json"
            )
        if self.address and self.jobs != Sweep.jobs:
            raise ConfigError(
                "sweep: --jobs is for this machine; the cluster of --address has its own"
            )

    def _read(self, folder: Path) -> Store:
        store = read_store(folder)
        if store is None or not store.rows:
            raise OutputError(f"{str(folder)!r} holds no results of a sweep")
        return store

    def _sweep(self, folder: Path, screen: Console) -> Store:
        """Do the runs that are not on file."""
        if self.jobs < 1:
            raise ConfigError(f"jobs {self.jobs}: must be 1 or more")
        grid = read_grid(self.options, self.grid, self.starts, self.seeds)
        require_extras(grid)
        pool = self._pool()
        folder = output_file(f"{folder}/{TABLE}", "", ".parquet").parent
        with locked(folder):
            store = open_store(folder, grid, sources(grid))
            missing = store.missing()
            cells = len(store.grid.cells())
            screen.print(
                f"{len(store.grid)} runs: {cells} combinations, {store.grid.seeds} seeds; "
                f"{len(store.rows)} are on file",
                soft_wrap=True,
            )
            if missing:
                with screen.status("") as status:
                    check_grid(grid, status.update)
                store.fold()  # a folder that cannot be written is told of before the work
                _do(store, missing, pool, folder, screen)
        return store

    def _pool(self) -> _Pool:
        """Return what does the runs."""
        if self.address and self.backend == "processes":
            raise ConfigError("sweep: --address is of a Ray cluster, not for --backend processes")
        wanted = self.address or self.backend == "ray"
        if wanted and not has_ray():
            raise ConfigError(
                "sweep: --address and --backend ray need Ray: pip install 'nomad-mj[sweep]'"
            )
        if self.backend == "processes" or not has_ray():
            return partial(do_in_processes, jobs=self.jobs)
        return partial(do_on_ray, jobs=self.jobs, address=self.address)

    def _show(self, store: Store, folder: Path, screen: Console) -> None:
        """Print the table; write it as Markdown, and the figures."""
        metrics = choose_metrics(store, self.metric)
        table = make_summary(store, metrics)
        screen.print(as_rich(table))
        text = f"{table.title}\n\n{as_markdown(table)}".encode()
        write_atomically(folder / "sweep.md", lambda file: file.write(text))
        pictures, left_out = draw(store, metrics, folder)
        if left_out:
            screen.print(f"{left_out} panels more than fit a figure are not drawn")
        for path in [folder / TABLE, *pictures]:
            screen.print(str(path), soft_wrap=True)
        if self.json:
            print_json(_told(store, metrics))


def _do(store: Store, missing: list[SweepRun], pool: _Pool, folder: Path, screen: Console) -> None:
    """Do runs with a progress bar, and keep what is done whatever ends this."""
    total = len(store.grid)
    try:
        with (
            run_progress(screen) as progress,
            closing(pool(partial(do_run, store.sources), missing)) as done,
        ):
            task = progress.add_task("runs", total=total, completed=len(store.rows))
            for run, row in done:
                store.add(run, row)
                progress.update(task, completed=len(store.rows))
    except BaseException:
        shows = f"nomad-mj sweep --only-read --out {shlex.quote(str(folder))}"
        screen.print(
            f"{len(store.rows)} of {total} runs are on file; the same command goes on from there, "
            f"{shows} shows what there is",
            soft_wrap=True,
        )
        raise
    finally:
        store.fold()


def _told(store: Store, metrics: Sequence[str]) -> dict[str, object]:
    """Return the numbers behind the table by combination."""
    cells = {
        describe(cell): {m: spread([column(store, cell, m)])._asdict() for m in metrics}
        for cell in store.grid.cells()
    }
    return {"runs": len(store.rows), "of": len(store.grid), "cells": cells}
