"""``nomad-mj demo``: learn the paper's room, compare, and show it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from nomad_agents.agent import Agent
from nomad_agents.cli.common import console, interruptible, output_file, print_json
from nomad_agents.cli.evaluate import format_metric, run_evaluation
from nomad_agents.cli.train import run_training
from nomad_agents.evaluation import Trial, draw_starts, summarise
from nomad_agents.experiments.figures import Panel, draw_actions, draw_paths
from nomad_agents.experiments.lattice import lattice
from nomad_agents.experiments.pictures import LATTICE, action_map, spread_starts, way
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.recording import record
from nomad_agents.registry import find_config, make_agent
from nomad_agents.task_options import TaskOptions
from nomad_agents.training import Training, TrainingConfig, training_report
from nomad_mj.envs import DEFAULT_ROOM, PathFinding
from nomad_mj.errors import ConfigError, RenderError

# Section 4 of the paper.
PAPER = {
    "reactions": "1424",
    "plannings": "248",
    "virtual_collisions": "74",
    "bumper_contacts": "",
    "categories": "29",
    "exemplars": "93",
}
LEARNING_ROWS = {
    "reactions": "reactions",
    "plannings": "plannings",
    "virtual_collisions": "virtual collisions",
    "bumper_contacts": "bumper contacts",
    "categories": "categories",
    "exemplars": "exemplars",
}
UNSEEN_ROWS = {
    "success_rate": "goal reached",
    "strict_success_rate": "without virtual collision",
    "spl": "SPL",
    "path_ratio_median": "path / shortest, median",
}


@dataclass(frozen=True)
class Demo(TaskOptions):
    """Train in a room, the paper's by default, print the table, write video and figures."""

    config: str = "faithful"
    """Parameters: faithful (the paper's) or tuned (fewer virtual collisions in such rooms)."""
    seed: int = 0
    """Of all randomness."""
    starts: int = 100
    """Unseen starts that the trained agent and the baselines are evaluated on."""
    videos: int = 6
    """Starts that the video shows."""
    speed: float = 4.0
    """Video time runs so many times faster than simulated time."""
    out: str = "renders"
    """Folder for ROOM.npz, ROOM.mp4, and fig6 and fig7 as .png and .pdf."""
    json: bool = False
    """Print one line of JSON last on standard output."""

    def run(self) -> int:
        """Train, compare, draw and record; return the exit code."""
        for name, given, least in (("starts", self.starts, 1), ("videos", self.videos, 0)):
            if given < least:
                raise ConfigError(f"{name} {given}: must be {least} or more")
        if not 0.01 <= self.speed <= 1000:
            raise ConfigError(f"speed {self.speed}: must be from 0.01 to 1000")
        screen = console(json_wanted=self.json)
        with self.path_finding() as env, interruptible():
            path = output_file(self.out, env.scene.arena.name, ".npz")
            agent = ReactivePlanner(env.scene.robot.layout, find_config(self.config))
            training = Training()
            settings = TrainingConfig(self.seed)
            run_training(env, agent, settings, training, path, screen, self.conditions())
            report = training_report(env, agent, training)
            summaries = self._compare(env, agent, screen)
            room = env.scene.arena.name
            title = f"{room}, seed {self.seed}"
            screen.print(_table(title, report, summaries, as_paper=room == DEFAULT_ROOM))
            trials = self._draw(env, agent, path.parent, screen)
            shown = self._record(env, agent, trials, path.with_suffix(".mp4"), screen)
        files = [path.name, "fig6.png", "fig7.png", *([f"{path.stem}.mp4"] if shown else [])]
        screen.print(f"In {path.parent}: {', '.join(files)}", soft_wrap=True)
        if self.json:
            print_json({"training": report, "unseen": summaries})
        return 0

    def _compare(
        self, env: PathFinding, agent: ReactivePlanner, screen: Console
    ) -> dict[str, dict[str, Any]]:
        """Return the metrics of the trained agent and of the baselines on unseen starts."""
        starts = draw_starts(env, self.starts, self.seed)
        agents: list[Agent] = [
            agent,
            *(make_agent(name, agent.layout, agent.config) for name in ("straight", "planner")),
        ]
        return {
            each.name: summarise(env, run_evaluation(env, each, starts, self.seed, 60, screen))
            for each in agents
        }

    def _draw(self, env: PathFinding, agent: Agent, folder: Path, screen: Console) -> list[Trial]:
        """Write Figs 6 and 7; return the episodes of Fig 6."""
        scene = env.scene
        starts = scene.arena.starts[spread_starts(env, 12)]
        trials = run_evaluation(env, agent, starts, self.seed, 100, screen)
        ways = [way(trial) for trial in trials]
        draw_paths([Panel("Paths after learning", scene, ways)], folder / "fig6")
        actions = action_map(env, agent, lattice(scene, LATTICE), self.seed)
        draw_actions([Panel("The learnt action at every place", scene, actions)], folder / "fig7")
        return trials

    def _record(
        self, env: PathFinding, agent: Agent, trials: list[Trial], path: Path, screen: Console
    ) -> bool:
        """Write the video; return False, having said why, where there is no OpenGL."""
        starts = [trial.start.tolist() for trial in trials[: self.videos]]
        if not starts:
            return False
        try:
            with screen.status(f"recording {path.name}"):
                record(env, agent, path, starts=starts, seed=self.seed, speed=self.speed)
        except RenderError as error:
            screen.print(f"no video: {error}", soft_wrap=True)
            return False
        return True


def _table(
    title: str, report: dict[str, Any], summaries: dict[str, dict[str, Any]], *, as_paper: bool
) -> Table:
    """Return the table paper | this run | straight to the goal | planner at every decision."""
    paper = PAPER if as_paper else dict.fromkeys(PAPER, "")
    table = Table(title=title)
    for heading in ("", "paper", "this run", "straight to\nthe goal", "planner at every\ndecision"):
        table.add_column(heading, justify="right" if heading else "left")
    table.add_row("while learning")
    solved = f"{report['solved']} of {report['starts']}"
    table.add_row("  starts solved", "50 of 50" if as_paper else "", solved)
    for key, label in LEARNING_ROWS.items():
        table.add_row(f"  {label}", paper[key], str(report[key]))
    table.add_section()
    table.add_row(f"on {summaries[ReactivePlanner.name]['episodes']} unseen starts")
    for key, label in UNSEEN_ROWS.items():
        table.add_row(f"  {label}", "", *(format_metric(s[key]) for s in summaries.values()))
    return table
