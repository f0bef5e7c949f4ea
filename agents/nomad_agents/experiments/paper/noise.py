"""Noise of the range sensors: how much of it, of which kind, and echoes that do not come back."""

import math
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np

import nomad_mj
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
from nomad_agents.experiments.learnt import (
    acting_agent,
    kept_agent,
    new_learner,
    trained_agent,
)
from nomad_agents.experiments.pictures import spread_starts
from nomad_agents.registry import find_config
from nomad_agents.studies.measures import assess, episode_rows
from nomad_agents.studies.runs import Result, Run
from nomad_agents.training import TrainingConfig
from nomad_mj.envs import PathFinding
from nomad_mj.scene import build_scene
from nomad_mj.tasks import RangeNoise

_PAPER, _ECHOES = "±15 %", "lost echoes"
NOISES = {
    "none": RangeNoise("none", 0.0),
    "±5 %": RangeNoise(level=0.05),
    _PAPER: RangeNoise(level=0.15),
    "±30 %": RangeNoise(level=0.30),
    "Gaussian 15 %": RangeNoise("gaussian", 0.15),
    _ECHOES: RangeNoise(level=0.15, grazing=math.radians(30)),
}
_MOST_PASSES = 6


def _open(run: Run) -> PathFinding:
    noise = {"range_noise": NOISES[run.case]}
    return nomad_mj.load("path_finding", room=run.room, robot=run.robot, task_kwargs=noise)


@lru_cache
def _has_sonar(study: Study) -> bool:
    rings = build_scene(study.room, study.robot).robot.layout.rings
    return "sonar" in [ring.name for ring in rings]


class Noise(Experiment):
    """Learning and driving with worse sensors, and with better ones."""

    name = "noise"
    title = "Noisy range sensors"
    claim = "The approach deals effectively with noisy sensors: readings are wrong by up to 15 %."
    source = "sections 2.1 and 4"
    table = tuple(
        TableRow(f"{case}: {label}", key, case, digits=digits, total=total)
        for case in NOISES
        for label, key, digits, total in (
            ("runs that solve every start", "learn_solved_all", 0, True),
            ("reactions until then", "learn_reactions", 0, False),
            ("goal reached from unseen starts", "success_rate", 3, False),
            ("without any virtual collision", "strict_success_rate", 3, False),
            ("bumper contacts while learning", "learn_bumper_contacts", 0, False),
        )
    )

    def runs(self, study: Study) -> list[Run]:
        """Return a run for each kind of noise, agent and seed; echoes are those of a sonar."""
        cases = [case for case in NOISES if case != _ECHOES or _has_sonar(study)]
        return self.plan_runs(study, cases, (STRAIGHT, PLANNER), costly=(_ECHOES,))

    def work(self, run: Run, folder: Path) -> Result:
        """Learn the room with this noise, then drive with it."""
        noise = NOISES[run.case]
        result = Result(run, {"level": noise.level, "kind": noise.kind})
        with _open(run) as env:
            if run.agent == LEARNER and noise != RangeNoise():
                settings = TrainingConfig(run.seed, max_passes=_MOST_PASSES, whole_tests=False)
                agent = new_learner(result, folder, env, find_config(run.config), settings)
            else:
                agent = acting_agent(run, folder, env)
                if run.agent == LEARNER:  # which has learnt with this noise
                    result.row |= trained_agent(run, folder)[1].row
            row, trials = assess(env, agent, run.seed)
            result.row |= row
            result.episodes = episode_rows(trials)
        return result

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Ask for as good driving with the paper's noise as with none."""
        without, paper, double = (
            float(np.median(column(results, "success_rate", case)))
            for case in ("none", _PAPER, "±30 %")
        )
        reason = (
            f"the goal is reached from {paper:.1%} of unseen starts with the paper's noise, from "
            f"{without:.1%} without any, from {double:.1%} with twice as much"
        )
        if paper >= without - 0.02:
            return Verdict("holds" if double >= 0.9 else "holds in part", reason)
        return Verdict("holds in part" if paper >= 0.9 else "does not hold", reason)

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show the most noise."""
        case = "±30 %"
        run = Run(self.name, case, LEARNER, study.config, study.room, study.robot, 0)
        env = _open(run)
        starts = spread_starts(env, 3)
        return Showcase(env, kept_agent(run, folder), starts, subtitle=f"noise {case}")
