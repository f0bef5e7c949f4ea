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
from nomad_agents.benchmark.conditions import condition_of, find_condition
from nomad_agents.deep.extra import DEEP_PACKAGES
from nomad_agents.evaluation import Trial
from nomad_agents.learners import Learner, Lesson, find_learner
from nomad_agents.studies.measures import assess, episode_rows
from nomad_agents.studies.runs import Result, Row, Run
from nomad_mj.envs import PathFinding
from nomad_mj.scene import build_scene


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
    def learner(self) -> Learner:
        """How its agent comes to be."""
        return find_learner(f"{self.agent}:{self.config}")[0]

    @property
    def label(self) -> str:
        """What the agent is called: of those that do not learn, the first variant is not named."""
        learner = self.learner
        plain = self.config == learner.variants[0] and not learner.learns
        return self.agent if plain else f"{self.agent}:{self.config}"

    def packages(self) -> tuple[str, ...]:
        """Return whose versions its numbers depend on."""
        return (*super().packages(), *(DEEP_PACKAGES if self.learner.deep else ()))

    def identity(self) -> Row:
        """Return what tells it from other runs: of who learns nothing, nothing of learning."""
        own = super().identity()
        if not self.learner.learns:
            for name in ("budget", "check_starts", "whole_curves"):
                del own[name]
        return own

    def parameters(self) -> Row:
        """Return what agent and condition stand for."""
        condition = {k: cattrs.unstructure(v) for k, v in find_condition(self.condition).items()}
        return {"agent": self.learner.parameters(self.config), "condition": condition}


def _task(run: BenchmarkRun) -> dict[str, Any]:
    """Return the task as arguments of `nomad_mj.load`."""
    return {
        "room": run.room,
        "robot": run.robot,
        "task_kwargs": condition_of(run.condition, build_scene(run.room, run.robot).robot.layout),
    }


def _open(task: dict[str, Any], **others: Any) -> closing[PathFinding]:
    return closing(nomad_mj.load("path_finding", **(task | others)))


def work(run: Run, folder: Path) -> Result:
    """Do one run; called in a process of its own."""
    assert isinstance(run, BenchmarkRun)
    task = _task(run)
    limited = {"environment_kwargs": {"time_limit": run.time_limit}}
    with _open(task, **limited) as env:
        checks = Checks(env, run.check_starts, run.seed, run.decisions, whole=run.whole_curves)
        lesson = Lesson(run.config, run.seed, run.budget, partial(_open, task), task, checks)
        began = time.perf_counter()
        agent, row = run.learner.learn(lesson)
        learnt = round(time.perf_counter() - began, 3)
        metrics, trials = assess(env, agent, run.seed, run.starts, run.decisions)
        row = metrics | {"barn_score": barn_score(env, trials)} | row
    row |= until_mastered(checks.curve)
    result = Result(run, row, episode_rows(trials), checks.curve)
    result.machine["learn_wall_s"] = learnt
    return result


def barn_score(env: PathFinding, trials: Sequence[Trial]) -> float:
    """Return the mean of S OT / clip(T, 4 OT, 8 OT), from 0 to 0.25 (BARN challenge, ICRA 2022).

    S is 1 where the goal was reached, else 0; T the time it took; OT the time that the shortest
    path takes at the robot's top speed.
    """
    speed = env.scene.robot.drive.limits.translate
    return float(np.mean([barn_score_of(trial, speed) for trial in trials]))


def barn_score_of(trial: Trial, speed: float) -> float:
    """Return the score of one episode with a robot of a top speed [m/s]."""
    best, took = trial.shortest / speed, trial.episode.duration  # [s]
    if not trial.episode.reached or not np.isfinite(best):
        return 0.0
    if best <= 0:  # a start at the goal leaves nothing to be quick at
        return 0.25
    return best / float(np.clip(took, 4 * best, 8 * best))
