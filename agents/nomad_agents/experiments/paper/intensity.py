"""Fig 14: the situation without the intensity of the attraction force, ten starts."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import nomad_mj
from nomad_agents.evaluation import evaluate
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
from nomad_agents.experiments.learnt import acting_agent, kept_agent, new_learner
from nomad_agents.experiments.pictures import spread_starts, way
from nomad_agents.registry import find_config
from nomad_agents.studies.measures import DECISIONS, assess, episode_rows
from nomad_agents.studies.runs import Result, Run
from nomad_agents.training import TrainingConfig
from nomad_mj.envs import PathFinding

STARTS = 10
UNSEEN = 50
_MOST_PASSES = 40


def _open(run: Run) -> PathFinding:
    return nomad_mj.load("path_finding", room=run.room, robot=run.robot)


def _starts(env: PathFinding) -> tuple[int, ...]:
    """Return the numbers of ten of the room's starts that lie far from each other."""
    return tuple(spread_starts(env, STARTS))


class NoIntensity(Experiment):
    """Fig 14."""

    name = "fig14"
    title = "Without the distance to the goal"
    claim = (
        "Knowing only the direction of the goal, not its distance, the robot learns ten starts "
        "with 94 plannings and 492 reactions."
    )
    source = "section 7.1, Fig 14"
    needs_trained = False
    table = (
        TableRow("runs that solve all ten starts", "learn_solved_all", paper="1 of 1", total=True),
        TableRow("reactions until then", "learn_reactions", paper="492"),
        TableRow("plannings", "learn_plannings", paper="94"),
        TableRow("virtual collisions", "learn_virtual_collisions"),
        TableRow("categories", "learn_categories"),
        TableRow("exemplars", "learn_exemplars"),
        TableRow("goal reached from unseen starts", "success_rate", digits=3),
        TableRow("without any virtual collision", "strict_success_rate", digits=3),
    )

    def runs(self, study: Study) -> list[Run]:
        """Return a run a seed, and some of the baselines."""
        return self.plan_runs(study, ("",), (STRAIGHT, PLANNER))

    def work(self, run: Run, folder: Path) -> Result:
        """Learn ten starts, then drive from unseen ones."""
        result = Result(run, {})
        with _open(run) as env:
            starts = _starts(env)
            if run.agent == LEARNER:
                config = find_config(run.config)
                situation = replace(config.situation, use_intensity=False)
                config = replace(config, situation=situation)
                settings = TrainingConfig(run.seed, max_passes=_MOST_PASSES, starts=starts)
                agent = new_learner(result, folder, env, config, settings)
            else:
                agent = acting_agent(run, folder, env)
            row, trials = assess(env, agent, run.seed, UNSEEN)
            result.row |= row
            result.episodes = episode_rows(trials)
            if run.seed == 0:
                places = env.scene.arena.starts[list(starts)]
                shown = evaluate(env, agent, places, run.seed, DECISIONS)
                result.pictures = {"ways": [way(trial) for trial in shown]}
        return result

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Compare with the paper's counts."""
        solved = column(results, "learn_solved_all")
        reactions, plannings = (
            float(np.median(column(results, key))) for key in ("learn_reactions", "learn_plannings")
        )
        reason = (
            f"{int(solved.sum())} of {len(solved)} runs solve the ten starts, in the median with "
            f"{plannings:.0f} plannings and {reactions:.0f} reactions"
        )
        if solved.all() and reactions <= 492 and plannings <= 94:
            return Verdict("holds", reason)
        return Verdict("holds in part" if solved.mean() >= 0.5 else "does not hold", reason)

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show four of the ten starts."""
        run = self.runs(study)[0]
        env = _open(run)
        agent = kept_agent(run, folder)
        return Showcase(env, agent, list(_starts(env)[:4]), subtitle="no intensity")
