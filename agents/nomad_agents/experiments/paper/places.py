"""Figs 9 and 10: what the learnt actions are worth with another goal, and in another room."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

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
from nomad_agents.experiments.figures import lattice
from nomad_agents.experiments.learnt import (
    acting_agent,
    keep_agent,
    kept_agent,
    learn,
    trained_agent,
)
from nomad_agents.experiments.measures import assess, episode_rows, judge_actions
from nomad_agents.experiments.pictures import LATTICE, action_map, way
from nomad_agents.experiments.runs import Result, Row, Run
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.registry import find_config
from nomad_agents.training import TrainingConfig
from nomad_mj.envs import PathFinding

_ADAPTING_SEED = 100_000  # added: other random numbers than those of the first training
_MOST_PASSES = 8
_SHOWN = 8


class Place(NamedTuple):
    """Another room (that of the study if empty), another goal [m] (the room's own if None)."""

    room: str = ""
    goal: tuple[float, float] | None = None


PLACES = {
    "goal (2.4, 4.2)": Place(goal=(2.4, 4.2)),
    "goal (5, 2)": Place(goal=(5.0, 2.0)),
    "clutter": Place(room="clutter"),
}
ADAPTED = ("goal (2.4, 4.2)", "clutter")  # learning takes its time: one place of each kind


def _open(run: Run) -> PathFinding:
    """Return the other place of a run's case."""
    place = PLACES[run.case]
    return nomad_mj.load(
        "path_finding", room=place.room or run.room, robot=run.robot, goal=place.goal
    )


def _pictures(env: PathFinding, agent: ReactivePlanner, run: Run) -> tuple[Row, Row]:
    """Return what the map of actions is worth, and what is drawn of a place."""
    actions = action_map(env, agent, lattice(env.scene, LATTICE), run.seed)
    held = {"actions": actions, "goal": env.scene.arena.goal.tolist()}
    return judge_actions(env, actions), {**held, "room": PLACES[run.case].room or run.room}


class OtherPlaces(Experiment):
    """Fig 9."""

    name = "fig9"
    title = "Another goal, another room: before adapting"
    claim = (
        "In a new environment the robot handles some situations correctly, applies unsuitable "
        "rules in others, and does not know how to act in most of it."
    )
    source = "section 4, Fig 9"
    table = tuple(
        TableRow(f"{case}: {label}", key, case, digits=3)
        for case in PLACES
        for label, key in (
            ("places whose situation is known", "known"),
            ("suitable actions among these", "known_suitable"),
            ("goal reached by reactions alone", "success_alone"),
            ("goal reached", "success_rate"),
        )
    )

    def runs(self, study: Study) -> list[Run]:
        """Return a run for each place, agent and seed."""
        return self.plan_runs(study, list(PLACES), (STRAIGHT, PLANNER))

    def work(self, run: Run, folder: Path) -> Result:
        """Send an agent that learnt one place to another."""
        result = Result(run, {})
        with _open(run) as env:
            agent = acting_agent(run, folder, env)
            row, trials = assess(env, agent, run.seed)
            result.episodes = episode_rows(trials)
            result.row |= row
            if isinstance(agent, ReactivePlanner):
                judged, pictures = _pictures(env, agent, run)
                result.row |= judged
                if run.seed == 0:
                    result.pictures = {**pictures, "ways": [way(t) for t in trials[:_SHOWN]]}
                agent.config = replace(agent.config, no_match="stay")
                alone, _ = assess(env, agent, run.seed)
                result.row["success_alone"] = alone["success_rate"]
        return result

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Ask for situations that are known, and for many that are not."""
        known = float(np.median(column(results, "known")))
        suitable = float(np.nanmedian(column(results, "known_suitable")))
        reason = (
            f"{known:.0%} of the situations are known, and {suitable:.0%} of the actions taken in "
            "these are suitable"
        )
        claims = (known < 0.5, 0.2 <= suitable <= 0.95)
        if all(claims):
            return Verdict("holds", reason)
        return Verdict("holds in part" if any(claims) else "does not hold", reason)

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show what the robot does where it has not learnt."""
        case = next(iter(PLACES))
        run = Run(self.name, case, LEARNER, study.config, study.room, study.robot, 0)
        agent, _ = trained_agent(run, folder)
        return Showcase(_open(run), agent, [0, 1, 2], subtitle=f"{case}, not adapted")


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
        return self.plan_runs(study, ADAPTED, (STRAIGHT, PLANNER), costly=("clutter",))

    def work(self, run: Run, folder: Path) -> Result:
        """Let an agent that learnt one place learn another, beside one that learnt none."""
        with _open(run) as env:
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
                judged, pictures = _pictures(env, agent, run)
                result.row |= judged
                if run.seed == 0:
                    result.pictures = {**pictures, "ways": [way(t) for t in trials[:_SHOWN]]}
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
        """Ask for fewer reactions than from scratch."""
        solved = column(results, "learn_solved_all")
        adapted = float(np.median(column(results, "learn_reactions")))
        scratch = float(np.median(column(results, "scratch_reactions")))
        plans = float(np.median(column(results, "learn_plannings")))
        plans_scratch = float(np.median(column(results, "scratch_plannings")))
        old = float(np.median(column(results, "old_success_rate")))
        reason = (
            f"{solved.mean():.0%} of the runs adapt, in the median with {adapted:.0f} reactions "
            f"and {plans:.0f} plannings; from scratch it takes {scratch:.0f} and "
            f"{plans_scratch:.0f}; {old:.0%} of starts still reach the old goal"
        )
        if solved.mean() >= 0.9 and adapted <= 1424:
            return Verdict("holds", reason)
        return Verdict("holds in part" if solved.mean() >= 0.5 else "does not hold", reason)

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show the robot after adapting."""
        case = ADAPTED[0]
        run = Run(self.name, case, LEARNER, study.config, study.room, study.robot, 0)
        return Showcase(_open(run), kept_agent(run, folder), [0, 1, 2], subtitle=f"{case}, adapted")
