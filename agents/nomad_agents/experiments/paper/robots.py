"""Other robots in other rooms: the same agent, unchanged."""

from collections.abc import Sequence
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
from nomad_agents.experiments.learnt import acting_agent, kept_agent, new_learner
from nomad_agents.experiments.pictures import spread_starts, way
from nomad_agents.registry import find_config
from nomad_agents.studies.measures import assess, episode_rows
from nomad_agents.studies.runs import Result, Run
from nomad_agents.training import TrainingConfig

ROBOTS = ("nomad200", "pioneer", "khepera", "omnibot", "racer")
ROOMS = ("empty_room", "paper_room", "clutter", "hall")
_MOST_PASSES = 8
_SHOWN = 8
CASES = {f"{robot}, {room}": (robot, room) for robot in ROBOTS for room in ROOMS}


class OtherRobots(Experiment):
    """Five robots in four rooms."""

    name = "robots"
    title = "Other robots, other rooms"
    claim = "What the agent learns from is a map and a goal: it is not made for one robot."
    source = "section 8"
    needs_trained = False
    table = tuple(
        TableRow(f"{case}: {label}", key, case, digits=digits, total=total)
        for case in CASES
        for label, key, digits, total in (
            ("runs that solve every start", "learn_solved_all", 0, True),
            ("reactions until then", "learn_reactions", 0, False),
            ("goal reached from unseen starts", "success_rate", 3, False),
        )
    )

    def runs(self, study: Study) -> list[Run]:
        """Return a run for each robot, room and seed; the baselines with one seed."""
        return [
            Run(self.name, case, agent, study.config, room, robot, seed)
            for case, (robot, room) in CASES.items()
            for agent in (LEARNER, STRAIGHT, PLANNER)
            for seed in range(study.seeds if agent == LEARNER else 1)
        ]

    def work(self, run: Run, folder: Path) -> Result:
        """Learn a room with a robot, then drive from unseen starts."""
        result = Result(run, {})
        with nomad_mj.load("path_finding", room=run.room, robot=run.robot) as env:
            if run.agent == LEARNER:
                settings = TrainingConfig(run.seed, max_passes=_MOST_PASSES, whole_tests=False)
                agent = new_learner(result, folder, env, find_config(run.config), settings)
            else:
                agent = acting_agent(run, folder, env)
            row, trials = assess(env, agent, run.seed)
            result.row |= row
            result.episodes = episode_rows(trials)
            if run.seed == 0:
                result.pictures = {"ways": [way(trial) for trial in trials[:_SHOWN]]}
        return result

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Ask every robot to learn every room."""
        solved = column(results, "learn_solved_all")
        reached = column(results, "success_rate")
        reason = (
            f"{int(solved.sum())} of {len(solved)} runs of {len(ROBOTS)} robots in {len(ROOMS)} "
            f"rooms solve every start; the goal is reached from {float(np.mean(reached)):.1%} of "
            "unseen starts"
        )
        if solved.mean() >= 0.9:
            return Verdict("holds", reason)
        return Verdict("holds in part" if solved.mean() >= 0.5 else "does not hold", reason)

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show the robot with the most uneven sensors."""
        case = "pioneer, paper_room"
        robot, room = CASES[case]
        run = Run(self.name, case, LEARNER, study.config, room, robot, 0)
        env = nomad_mj.load("path_finding", room=run.room, robot=run.robot)
        return Showcase(env, kept_agent(run, folder), spread_starts(env, 3), subtitle=case)
