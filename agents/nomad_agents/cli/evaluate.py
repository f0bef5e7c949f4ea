"""``nomad-mj evaluate``."""

import csv
import io
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from nomad_agents.agent import Agent
from nomad_agents.checkpoint import write_atomically
from nomad_agents.cli.common import console, interruptible, output_file, print_json
from nomad_agents.cli.progress import trial_progress
from nomad_agents.evaluation import Trial, draw_starts, evaluate, read_starts, summarise
from nomad_agents.registry import find_agent, find_config
from nomad_agents.task_options import TaskOptions
from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError
from nomad_mj.types import FloatArray

METRICS = {
    "episodes": "episodes",
    "success_rate": "reached the goal",
    "strict_success_rate": "without a virtual collision",
    "spl": "SPL (success weighted by path length)",
    "path_ratio_median": "path length / shortest path, median",
    "min_clearance_m": "least clearance, m",
    "virtual_collisions": "virtual collisions",
    "bumper_contacts": "bumper contacts",
    "no_match_rate": "episodes with an unknown situation",
    "mean_time_s": "mean time to the goal, s",
}


@dataclass(frozen=True)
class Evaluate(TaskOptions):
    """Run an agent greedily from many starts and measure how it does."""

    agent: str = "planner"
    """Checkpoint, .npz, or name of an agent; `nomad-mj list` tells the names."""
    config: str = "faithful"
    """Parameters of an agent given by name, faithful or tuned; a checkpoint has its own."""
    starts: str = "200"
    """Number of unseen starts, drawn from --seed, or a file of lines x,y[,heading], metres and
    radians."""
    seed: int = 0
    """Of the starts and of the sensors' noise."""
    max_decisions: int = 100
    """An episode is given up after so many decisions."""
    out: str = ""
    """Write one row an episode to this .csv file, or into this folder."""
    json: bool = False
    """Print one line of JSON last on standard output."""

    def run(self) -> int:
        """Evaluate; return the exit code."""
        require_decisions(self.max_decisions)
        screen = console(json_wanted=self.json)
        with self.path_finding() as env, interruptible():
            agent = find_agent(self.agent, env.scene.robot.layout, find_config(self.config))
            name = f"{env.scene.arena.name}_{env.scene.robot.name}_{agent.name}_evaluation"
            path = output_file(self.out, name, ".csv") if self.out else None
            starts = choose_starts(env, self.starts, self.seed)
            trials = run_evaluation(env, agent, starts, self.seed, self.max_decisions, screen)
            summary = summarise(env, trials)
        if path is not None:
            text = rows_as_csv(trials).encode()
            write_atomically(path, lambda file: file.write(text))
        table = Table("", agent.name, title=f"{agent.name} in {self.room}")
        for key, label in METRICS.items():
            table.add_row(label, format_metric(summary[key]))
        screen.print(table)
        if self.json:
            print_json(summary)
        return 0


def require_decisions(most: int) -> None:
    """Raise ConfigError unless an episode may have some decisions."""
    if most < 1:
        raise ConfigError(f"max_decisions {most}: must be 1 or more")


def choose_starts(env: PathFinding, starts: str, seed: int) -> FloatArray:
    """Return the starts (n, 3) that `--starts` means: a number of them, or those of a file."""
    if seed < 0:
        raise ConfigError(f"seed {seed}: must be 0 or more")
    try:
        count = int(starts)
    except ValueError:
        return read_starts(Path(starts))
    return draw_starts(env, count, seed)


def run_evaluation(
    env: PathFinding,
    agent: Agent,
    starts: FloatArray,
    seed: int,
    max_decisions: int,
    screen: Console,
) -> list[Trial]:
    """Evaluate with a progress bar; see `evaluation.evaluate`."""
    with trial_progress(screen) as progress:
        task = progress.add_task(f"evaluating {agent.name}", total=len(starts))
        return evaluate(env, agent, starts, seed, max_decisions, lambda _: progress.advance(task))


def format_metric(value: float) -> str:
    """Return a number as people read it: whole ones whole, others with three decimals."""
    return f"{value}" if isinstance(value, int) else f"{value:.3f}"


def rows_as_csv(trials: list[Trial]) -> str:
    """Return one row an episode, with a header."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = [*Trial.__annotations__["episode"]._fields]
    writer.writerow(["x", "y", "heading", *names, "length", "shortest"])
    for trial in trials:
        numbers = [f"{v:.6g}" if isinstance(v, float) else int(v) for v in trial.episode]
        place = [f"{v:.6g}" for v in trial.start.tolist()]
        writer.writerow([*place, *numbers, f"{trial.length:.6g}", f"{trial.shortest:.6g}"])
    return text.getvalue()
