"""Every reading of the text that mattered, against its alternatives, one at a time."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

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
from nomad_agents.experiments.learnt import trained_agent
from nomad_agents.experiments.pictures import spread_starts
from nomad_agents.reactive_planner import ReactivePlanner, ReactivePlannerConfig
from nomad_agents.registry import find_config
from nomad_agents.studies.learning import learn
from nomad_agents.studies.measures import assess, episode_rows
from nomad_agents.studies.runs import Result, Run
from nomad_agents.training import TrainingConfig
from nomad_mj.motion import MotionConfig

_MOST_PASSES = 12
_UNSEEN = 100
_NOTHING: Mapping[str, Any] = {}


class Variant(NamedTuple):
    """What is different: fields of the configurations, the least number of passes."""

    agent: Mapping[str, Any] = _NOTHING
    planner: Mapping[str, Any] = _NOTHING
    situation: Mapping[str, Any] = _NOTHING
    motion: Mapping[str, Any] = _NOTHING
    min_passes: int = 2

    def differs(self, config: ReactivePlannerConfig) -> bool:
        """Return whether anything is different from a configuration as it is."""
        return self.change(config) != config or bool(self.motion) or self.min_passes != 2

    def change(self, config: ReactivePlannerConfig) -> ReactivePlannerConfig:
        """Return a configuration with what is different in the agent."""
        return replace(
            config,
            **self.agent,
            planner=replace(config.planner, **self.planner),
            situation=replace(config.situation, **self.situation),
        )


VARIANTS = {
    "as is": Variant(),
    "planner may run into things": Variant(planner={"occupied": 1.1}),
    "planner keeps no margin": Variant(planner={"margin": 0.0}),
    "planner keeps 0.15 m": Variant(planner={"margin": 0.15}),
    "planner keeps 0.25 m": Variant(planner={"margin": 0.25}),
    "k_ind 0.02": Variant({"k_ind": 0.02}),
    "k_ind 0.1": Variant({"k_ind": 0.1}),
    "direction on the circle": Variant(situation={"circular": True}),
    "direction on the segment": Variant(situation={"circular": False}),
    "memory of good actions": Variant({"remember_good_actions": True}),
    "sigma floor 0.1": Variant({"sigma_floor": 0.1}),
    "sigma floor 0.001": Variant({"sigma_floor": 0.001}),
    "unknown: stay": Variant({"no_match": "stay"}),
    "unknown: nearest": Variant({"no_match": "nearest"}),
    "unknown: plan": Variant({"no_match": "plan"}),
    "one pass is enough": Variant(min_passes=1),
    "no retreat": Variant(motion={"retract": 0.0}),
    "ahead ±45°": Variant(motion={"ahead": math.radians(45), "beside": 10.0}),
    "ahead ±60°": Variant(motion={"ahead": math.radians(60), "beside": 10.0}),
    "security distance 0.1 m": Variant(motion={"security_distance": 0.1}),
}


class Ablations(Experiment):
    """Which readings decide."""

    name = "ablations"
    title = "The readings of the text"
    claim = "The behaviour does not depend much on the parameters' values."
    source = "section 4, Table 1"
    needs_trained, shows_trained = False, True
    table = tuple(
        TableRow(f"{case}: {label}", key, case, digits=digits, total=total)
        for case in VARIANTS
        for label, key, digits, total in (
            ("runs that solve every start", "learn_solved_all", 0, True),
            ("reactions", "learn_reactions", 0, False),
            ("virtual collisions", "learn_virtual_collisions", 0, False),
            ("bumper contacts", "learn_bumper_contacts", 0, False),
            ("unseen starts without virtual collision", "strict_success_rate", 3, False),
        )
    )

    def runs(self, study: Study) -> list[Run]:
        """Return a run for each variant and seed."""
        return self.plan_runs(study, list(VARIANTS), ())

    def work(self, run: Run, folder: Path) -> Result:
        """Learn the room with one thing changed."""
        variant = VARIANTS[run.case]
        config = variant.change(find_config(run.config))
        options = {"motion": MotionConfig(**variant.motion)}
        with nomad_mj.load(
            "path_finding", room=run.room, robot=run.robot, task_kwargs=options
        ) as env:
            agent = ReactivePlanner(env.scene.robot.layout, config)
            settings = TrainingConfig(
                run.seed,
                min_passes=variant.min_passes,
                max_passes=_MOST_PASSES,
                whole_tests=False,
            )
            row, curve = learn(env, agent, settings)
            metrics, trials = assess(env, agent, run.seed, _UNSEEN)
        return Result(run, row | metrics, episode_rows(trials), curve)

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Count the variants that learn about as well, of those in which anything is different."""
        config = find_config(results[0].run.config)
        usual = float(np.median(column(results, "strict_success_rate", "as is")))
        alike = [
            column(results, "learn_solved_all", case).mean() >= 0.9
            and np.median(column(results, "strict_success_rate", case)) >= usual - 0.05
            for case, variant in VARIANTS.items()
            if variant.differs(config)
        ]
        reason = (
            f"{sum(alike)} of {len(alike)} variants solve every start in 9 of 10 runs and drive "
            "within 5 points as well from unseen starts"
        )
        share = float(np.mean(alike))
        if share >= 0.9:
            return Verdict("holds", reason)
        return Verdict("holds in part" if share >= 0.4 else "does not hold", reason)

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show the agent as it is."""
        run = Run(self.name, "as is", LEARNER, study.config, study.room, study.robot, 0)
        agent, _ = trained_agent(run, folder)
        env = nomad_mj.load("path_finding", room=run.room, robot=run.robot)
        return Showcase(env, agent, spread_starts(env, 2))
