"""One run of the benchmark: an agent learns a task, if it learns, and drives from unseen starts."""

import time
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import cattrs
import numpy as np

import nomad_mj
from nomad_agents.benchmark.checks import Checks, until_mastered
from nomad_agents.benchmark.conditions import find_condition
from nomad_agents.evaluation import Trial
from nomad_agents.experiments.measures import assess, episode_rows
from nomad_agents.experiments.runs import Result, Row, Run
from nomad_agents.learners import Lesson, find_learner
from nomad_mj.envs import PathFinding


@dataclass(frozen=True)
class BenchmarkRun(Run):
    """A run of the benchmark: `experiment` is its set, `config` the variant of its agent.

    Attributes
    ----------
    condition : str
        A name of `conditions.CONDITIONS`.
    time_limit, decisions : float, int
        An evaluated episode is given up after so many seconds or decisions.
    starts, check_starts : int
        Unseen starts of the evaluation, and of the checks while learning.
    budget : int
        Decisions of learning, at most.
    whole_curves : bool
        Whether checks go on when 90 % are mastered.
    """

    condition: str
    time_limit: float
    decisions: int
    starts: int
    check_starts: int
    budget: int
    whole_curves: bool

    @property
    def label(self) -> str:
        """What the agent is called: with its variant, unless that is the first one."""
        learner, variant = find_learner(f"{self.agent}:{self.config}")
        plain = variant == learner.variants[0] and not learner.learns
        return self.agent if plain else f"{self.agent}:{variant}"

    def parameters(self) -> Row:
        """Return what agent and condition stand for."""
        learner, variant = find_learner(f"{self.agent}:{self.config}")
        condition = {k: cattrs.unstructure(v) for k, v in find_condition(self.condition).items()}
        return {"agent": learner.parameters(variant), "condition": condition}


def _task(run: BenchmarkRun) -> dict[str, Any]:
    """Return the task as arguments of `nomad_mj.load`."""
    return {
        "room": run.room,
        "robot": run.robot,
        "task_kwargs": find_condition(run.condition),
    }


def _open(task: dict[str, Any], **others: Any) -> closing[PathFinding]:
    return closing(nomad_mj.load("path_finding", **(task | others)))


def work(run: Run, folder: Path) -> Result:
    """Do one run; called in a process of its own."""
    assert isinstance(run, BenchmarkRun)
    task = _task(run)
    limited = {"environment_kwargs": {"time_limit": run.time_limit}}
    learner, variant = find_learner(f"{run.agent}:{run.config}")
    with _open(task, **limited) as env:
        checks = Checks(env, run.check_starts, run.seed, run.decisions, whole=run.whole_curves)
        lesson = Lesson(variant, run.seed, run.budget, partial(_open, task), task, checks)
        began = time.perf_counter()
        agent, row = learner.learn(lesson)
        learnt = round(time.perf_counter() - began, 3)
        metrics, trials = assess(env, agent, run.seed, run.starts, run.decisions)
        row = metrics | {"barn_score": barn_score(env, trials)} | row
    row |= until_mastered(checks.curve)
    result = Result(run, row, episode_rows(trials), checks.curve)
    result.machine["learn_wall_s"] = learnt
    return result


def barn_score(env: PathFinding, trials: Sequence[Trial]) -> float:
    """Return the mean of S OT / clip(T, 4 OT, 8 OT), at most 0.25 (BARN challenge, ICRA 2022).

    T is the time it took, OT that of the shortest path at the robot's top speed.
    """
    speed = env.scene.robot.drive.limits.translate
    scores: list[float] = []
    for trial in trials:
        best, took = trial.shortest / speed, trial.episode.duration
        scored = trial.episode.reached and np.isfinite(best)
        # A start at the goal leaves nothing to be quick at.
        most = best / float(np.clip(took, 4 * best, 8 * best)) if scored and best > 0 else 0.25
        scores.append(most if scored else 0.0)
    return float(np.mean(scores))
