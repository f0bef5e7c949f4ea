"""Figs 11 and 12: a goal that moves, and obstacles that do."""

from abc import abstractmethod
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

import nomad_mj
from nomad_agents.agent import Agent
from nomad_agents.evaluation import Trial
from nomad_agents.experiments.experiment import (
    LEARNER,
    PLANNER,
    STRAIGHT,
    Experiment,
    Showcase,
    Study,
    TableRow,
    Verdict,
    column,
)
from nomad_agents.experiments.filming import Camera
from nomad_agents.experiments.learnt import acting_agent, trained_agent
from nomad_agents.experiments.pictures import Film
from nomad_agents.studies.measures import UNSEEN_SEED, episode_rows, unseen_starts
from nomad_agents.studies.runs import Result, Row, Run
from nomad_agents.training import stream
from nomad_mj.envs import PathFinding
from nomad_mj.movers import MovingGoal, MovingObstacles

LEARNING = {"learning off": False, "learning on": True}
_EPISODE, _EXPLORE = 30, 31  # kinds of streams
_FILMS = 4
_DECISIONS = 100  # a goal that moves away takes longer than one that stays


_LINES = (
    ("goal reached", "success_rate", 3),
    ("without any virtual collision", "strict_success_rate", 3),
    ("episodes without bumper contact", "no_contact_rate", 3),
    ("virtual collisions an episode", "collisions_per_episode", 2),
    ("mean time to the goal, s", "mean_time_s", 1),
)
_TABLE = tuple(
    TableRow(f"{case}: {label}", key, case, digits=digits)
    for case in LEARNING
    for label, key, digits in _LINES
)


class _Moving(Experiment):
    """What both have in common."""

    table = _TABLE

    def __init__(self, options: dict[str, Any]) -> None:
        self._options = options

    def open(self, run: Run) -> PathFinding:
        """Return the room with what moves in it."""
        return nomad_mj.load(
            "path_finding", room=run.room, robot=run.robot, task_kwargs=self._options
        )

    def runs(self, study: Study) -> list[Run]:
        """Return a run with and without learning a seed, and some of the baselines."""
        runs = self.plan_runs(study, list(LEARNING), (STRAIGHT, PLANNER))
        first = next(iter(LEARNING))  # the baselines do not learn
        return [run for run in runs if run.agent == LEARNER or run.case == first]

    def work(self, run: Run, folder: Path) -> Result:
        """Drive from the unseen starts, one episode after another."""
        with self.open(run) as env:
            agent = acting_agent(run, folder, env)
            trials, films = drive(env, agent, run.seed, LEARNING[run.case])
        result = Result(run, summarise(trials), episode_rows(trials))
        if run.seed == 0:
            result.pictures = {"films": films}
        return result

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show the agent that learnt the room when nothing moved in it."""
        run = self.runs(study)[0]
        agent, _ = trained_agent(run, folder)
        env = self.open(run)
        return Showcase(env, agent, unseen_starts(env, 3).tolist())

    @abstractmethod
    def judge(self, results: Sequence[Result]) -> Verdict:
        """Return whether the claim holds."""


def drive(
    env: PathFinding, agent: Agent, seed: int, learning: bool
) -> tuple[list[Trial], list[Film]]:
    """Run an agent from the unseen starts, and film some of the episodes.

    Parameters
    ----------
    env, agent
        Of the same robot; the agent is changed if it learns.
    seed : int
        Of all that moves, of the noise and of exploration.
    learning : bool
        Whether the agent goes on learning from episode to episode.
    """
    trials: list[Trial] = []
    films: list[Film] = []
    for number, start in enumerate(unseen_starts(env)):
        key = (UNSEEN_SEED + seed, number)
        explore = np.random.default_rng(stream(key[0], _EXPLORE, number)) if learning else None
        with Camera(env) as camera:
            episode = camera.run(
                agent, stream(key[0], _EPISODE, number), start, explore, _DECISIONS
            )
        # The shortest way to a goal that moves depends on where it will go.
        trials.append(Trial(start, episode, camera.track, float("nan")))
        if number < _FILMS:
            films.append(camera.film(episode.reached))
    return trials, films


def summarise(trials: Sequence[Trial]) -> Row:
    """Return the metrics of episodes in which something moves."""
    episodes = [trial.episode for trial in trials]
    times = [episode.duration for episode in episodes if episode.reached]
    return {
        "success_rate": float(np.mean([episode.reached for episode in episodes])),
        "strict_success_rate": float(np.mean([episode.strict for episode in episodes])),
        "no_contact_rate": float(np.mean([episode.bumper_contacts == 0 for episode in episodes])),
        "collisions_per_episode": float(np.mean([e.virtual_collisions for e in episodes])),
        "mean_time_s": float(np.mean(times)) if times else float("nan"),
    }


class GoalMoves(_Moving):
    """Fig 11."""

    name = "fig11"
    title = "A moving goal"
    claim = (
        "The robot tracks a goal that moves to the left in a random way, at up to half the "
        "robot's top speed."
    )
    source = "section 4, Fig 11"

    def __init__(self) -> None:
        super().__init__({"moving_goal": MovingGoal()})

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Ask for nearly every goal."""
        off, on = (float(np.mean(column(results, "success_rate", case))) for case in LEARNING)
        reason = (
            f"the goal is reached in {off:.1%} of the episodes, in {on:.1%} if learning goes on"
        )
        if off >= 0.98:
            return Verdict("holds", reason)
        return Verdict("holds in part" if off >= 0.8 else "does not hold", reason)


class ObstaclesMove(_Moving):
    """Fig 12."""

    name = "fig12"
    title = "Moving obstacles"
    claim = (
        "The robot avoids four obstacles that move towards the bottom in a random way, at up to "
        "half the robot's top speed."
    )
    source = "section 4, Fig 12"

    def __init__(self) -> None:
        super().__init__({"moving_obstacles": MovingObstacles()})

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Ask for goals that are reached without a contact."""
        reached = float(np.mean(column(results, "success_rate", "learning off")))
        clear = float(np.mean(column(results, "no_contact_rate", "learning off")))
        reason = (
            f"the goal is reached in {reached:.1%} of the episodes, {clear:.1%} have no contact"
        )
        if reached >= 0.95 and clear >= 0.99:
            return Verdict("holds", reason)
        return Verdict("holds in part" if reached >= 0.8 else "does not hold", reason)
