"""``nomad-mj reproduce``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro
from rich.table import Table

from nomad_agents.cli.common import (
    console,
    interruptible,
    output_file,
    path_finding,
    print_json,
)
from nomad_agents.cli.demo import LEARNING_ROWS, PAPER, UNSEEN_ROWS
from nomad_agents.cli.progress import trial_progress
from nomad_agents.experiments.learning import (
    BASELINE_SEEDS,
    BASELINES,
    UNSEEN_STARTS,
    learn_and_evaluate,
    quartiles,
)
from nomad_agents.experiments.runs import Row, Run, do_runs
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.registry import find_config
from nomad_mj.envs import DEFAULT_ROBOT, DEFAULT_ROOM
from nomad_mj.errors import ConfigError


@dataclass(frozen=True)
class Reproduce:
    """Repeat an experiment of the paper over many seeds, beside the baselines.

    fig6: learn the room until every start is solved, then 200 unseen starts.
    """

    experiment: Annotated[Literal["fig6"], tyro.conf.Positional] = "fig6"
    """Which."""
    seeds: int = 20
    """Runs, with the seeds 0, 1, ...; at most 5 of each baseline, which learns nothing."""
    config: str = "faithful"
    """Parameters: faithful (the paper's) or tuned (better ones found since)."""
    room: str = DEFAULT_ROOM
    """Name of a room, or an MJCF file."""
    robot: str = DEFAULT_ROBOT
    """Name of a robot, or an MJCF file."""
    jobs: int = 2
    """Processes."""
    out: str = "renders/reproduce"
    """Folder for one file a run; runs that are there are not done again."""
    json: bool = False
    """Print one line of JSON last on standard output."""

    def run(self) -> int:
        """Run what is missing; return the exit code."""
        if self.seeds < 1 or self.jobs < 1:
            raise ConfigError(f"seeds {self.seeds}, jobs {self.jobs}: must be 1 or more")
        find_config(self.config)
        with path_finding(self.room, self.robot):
            pass  # whatever is wrong with them is said now, and once
        screen = console(json_wanted=self.json)
        folder = output_file(f"{self.out}/rows", "probe", ".csv").parent
        rows: dict[str, list[Row]] = {}
        counts = dict.fromkeys(BASELINES, min(self.seeds, BASELINE_SEEDS))
        counts = {ReactivePlanner.name: self.seeds, **counts}
        with interruptible(), trial_progress(screen) as progress:
            task = progress.add_task(self.experiment, total=sum(counts.values()))
            for agent, count in counts.items():
                runs = [
                    Run(self.experiment, agent, self.config, self.room, self.robot, seed)
                    for seed in range(count)
                ]
                rows[agent] = do_runs(
                    runs, learn_and_evaluate, folder, self.jobs, lambda: progress.advance(task)
                )
        screen.print(self._table(rows))
        if self.json:
            print_json({agent: _spread(rows[agent]) for agent in rows})
        return 0

    def _table(self, rows: dict[str, list[Row]]) -> Table:
        """Return the table paper | ours | straight to the goal | planner at every decision."""
        room = Path(self.room).stem
        title = f"{room}, {self.config}, {self.seeds} seeds: median [quartiles]"
        table = Table("", "paper", "ours", "straight", "planner", title=title)
        learner = rows[ReactivePlanner.name]
        solved = sum(row["learn_solved"] == row["learn_starts"] for row in learner)
        table.add_row("seeds that solve every start", "1 of 1", f"{solved} of {len(learner)}")
        for key, label in LEARNING_ROWS.items():
            table.add_row(label, PAPER[key], _cell(learner, f"learn_{key}"))
        table.add_section()
        table.add_row(f"{UNSEEN_STARTS} unseen starts a seed")
        for key, label in UNSEEN_ROWS.items():
            table.add_row(f"  {label}", "", *(_cell(each, key) for each in rows.values()))
        return table


def _cell(rows: list[Row], key: str) -> str:
    """Return median and quartiles as people read them."""
    first, middle, third = quartiles(rows, key)
    digits = 0 if key.startswith("learn_") else 3
    return f"{middle:.{digits}f} [{first:.{digits}f}-{third:.{digits}f}]".replace("[", "\\[")


def _spread(rows: list[Row]) -> dict[str, Any]:
    """Return first quartile, median and third quartile of every column."""
    names = ("q1", "median", "q3")
    return {
        key: dict(zip(names, quartiles(rows, key), strict=True))
        for key in rows[0]
        if all(row[key] is not None for row in rows)
    }
