"""Fig 10: learning another goal, and another room, after the first."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

import nomad_mj
from nomad_agents.experiments.experiment import (
    LEARNER,
    Experiment,
    Showcase,
    Study,
    TableRow,
    Verdict,
    column,
)
from nomad_agents.experiments.learnt import acting_agent, keep_agent, kept_agent
from nomad_agents.experiments.paper.places import (
    SHOWN,
    cases_of,
    open_place,
    place_pictures,
    plan_places,
    verdict_of,
)
from nomad_agents.experiments.pictures import spread_starts, way
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.registry import find_config
from nomad_agents.studies.learning import learn
from nomad_agents.studies.measures import assess, episode_rows
from nomad_agents.studies.runs import Result, Row, Run
from nomad_agents.training import TrainingConfig
from nomad_mj.envs import PathFinding

ADAPTED = ("goal (2.4, 4.2)", "clutter")  # learning takes its time: one place of each kind
ENOUGH = 1424  # reactions, those of fig6 in the paper, which says only "a short time"
_ADAPTING_SEED = 100_000  # added: other random numbers than those of the first training
_MOST_PASSES = 8


class Adapting(Experiment):
    """Fig 10."""

    name = "fig10"
    title = "Another goal, another room: adapting"
    claim = "The robot adapts to a new environment in a short time."
    source = "section 4, Fig 10"
    table = tuple(
        TableRow(f"{case}: {label}", key, case, digits=digits, total=total)
        for case in ADAPTED
        for label, key, digits, total in (
            ("runs that solve every start", "learn_solved_all", 0, True),
            ("reactions until then", "learn_reactions", 0, False),
            ("plannings until then", "learn_plannings", 0, False),
            ("learning from scratch: reactions", "scratch_reactions", 0, False),
            ("learning from scratch: plannings", "scratch_plannings", 0, False),
            ("goal reached from unseen starts", "success_rate", 3, False),
            ("the first goal, still reached", "old_success_rate", 3, False),
        )
    )

    def runs(self, study: Study) -> list[Run]:
        """Return a run for each place and seed, and some of the baselines."""
        return plan_places(self, study, ADAPTED, ("clutter",))

    def work(self, run: Run, folder: Path) -> Result:
        """Let an agent that learnt one place learn another, beside one that learnt none."""
        with open_place(run) as env:
            agent = acting_agent(run, folder, env)
            result = Result(run, {})
            if isinstance(agent, ReactivePlanner):
                seed = _ADAPTING_SEED + run.seed
                result.row, result.curve = learn(
                    env, agent, TrainingConfig(seed, max_passes=_MOST_PASSES)
                )
            row, trials = assess(env, agent, run.seed)
            result.row |= row
            result.episodes = episode_rows(trials)
            if isinstance(agent, ReactivePlanner):
                result.row |= self._scratch(env, run)
                judged, pictures = place_pictures(env, agent, run)
                result.row |= judged
                if run.seed == 0:
                    result.pictures = {**pictures, "ways": [way(t) for t in trials[:SHOWN]]}
                    keep_agent(run, folder, env, agent)
        if isinstance(agent, ReactivePlanner):
            with nomad_mj.load("path_finding", room=run.room, robot=run.robot) as env:
                old, _ = assess(env, agent, run.seed)
                result.row["old_success_rate"] = old["success_rate"]
        return result

    @staticmethod
    def _scratch(env: PathFinding, run: Run) -> Row:
        """Return what learning takes an agent that knows nothing."""
        agent = ReactivePlanner(env.scene.robot.layout, find_config(run.config))
        settings = TrainingConfig(run.seed, max_passes=_MOST_PASSES, whole_tests=False)
        row, _ = learn(env, agent, settings)
        return {name.replace("learn_", "scratch_", 1): value for name, value in row.items()}

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Ask at each place for runs that adapt, in no more than the paper's reactions of fig6."""
        claims: list[bool] = []
        told: list[str] = []
        for case in cases_of(results):
            solved = column(results, "learn_solved_all", case)
            adapted, scratch, plans, plans_scratch, old = (
                float(np.median(column(results, key, case)))
                for key in (
                    "learn_reactions",
                    "scratch_reactions",
                    "learn_plannings",
                    "scratch_plannings",
                    "old_success_rate",
                )
            )
            claims.append(bool(solved.mean() >= 0.9 and adapted <= ENOUGH))
            told.append(
                f"in {case} {solved.sum():.0f} of {len(solved)} runs adapt, in the median with "
                f"{adapted:.0f} reactions and {plans:.0f} plannings, from scratch {scratch:.0f} "
                f"and {plans_scratch:.0f}; {old:.0%} of starts still reach the old goal"
            )
        return verdict_of(claims, "; ".join(told))

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show the robot after adapting."""
        case = self.runs(study)[0].case
        run = Run(self.name, case, LEARNER, study.config, study.room, study.robot, 0)
        env = open_place(run)
        agent = kept_agent(run, folder)
        return Showcase(env, agent, spread_starts(env, 3), subtitle=f"{case}, adapted")
