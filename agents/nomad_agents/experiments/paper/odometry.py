"""Fig 8: odometry that is wrong by up to 2 m, in one decision at each place and all the way."""

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
from nomad_agents.experiments.lattice import judge_actions, lattice
from nomad_agents.experiments.learnt import acting_agent, trained_agent
from nomad_agents.experiments.pictures import (
    LATTICE,
    action_map,
    share_alike,
    spread_starts,
)
from nomad_agents.studies.measures import assess, episode_rows
from nomad_agents.studies.runs import Result, Run
from nomad_mj.envs import PathFinding
from nomad_mj.tasks import OdometryNoise

ERRORS = {"exact": 0.0, "0.5 m": 0.5, "1 m": 1.0, "2 m": 2.0}
_ALIKE = np.radians(45)
# Near a goal that is told wrong the robot goes about until it meets it.
_DECISIONS, _TIME_LIMIT = 200, 1200.0


def _open(run: Run, error: float) -> PathFinding:
    noise = {"odometry_noise": OdometryNoise(position=error)}
    return nomad_mj.load(
        "path_finding",
        room=run.room,
        robot=run.robot,
        task_kwargs=noise,
        environment_kwargs={"time_limit": _TIME_LIMIT},
    )


class WrongOdometry(Experiment):
    """Fig 8."""

    name = "fig8"
    title = "Odometry wrong by up to 2 m"
    claim = (
        "With each coordinate of the robot's position wrong by U[-2, 2], anew at each decision, "
        "the map of actions is very similar to that of exact odometry."
    )
    source = "section 4, Fig 8"
    table = (
        *(
            TableRow(f"odometry ±{case}: actions within 45° of the exact ones", "alike", case,
                     "very similar" if case == "2 m" else "", 3)
            for case in list(ERRORS)[1:]
        ),
        *(
            TableRow(f"odometry {'±' * (case != 'exact')}{case}: goal reached", "success_rate",
                     case, digits=3)
            for case in ERRORS
        ),
        *(
            TableRow(f"odometry ±{case}: without virtual collision", "strict_success_rate", case,
                     digits=3)
            for case in list(ERRORS)[1:]
        ),
    )  # fmt: skip

    def runs(self, study: Study) -> list[Run]:
        """Return a run for each size of error, agent and seed."""
        return self.plan_runs(study, list(ERRORS), (STRAIGHT, PLANNER))

    def work(self, run: Run, folder: Path) -> Result:
        """Compare the maps of actions, then drive all the way."""
        error = ERRORS[run.case]
        with _open(run, 0.0) as exact, _open(run, error) as wrong:
            agent = acting_agent(run, folder, exact)
            places = lattice(exact.scene, LATTICE)
            actions = action_map(wrong, agent, places, run.seed)
            row = judge_actions(exact, actions)
            row["alike"] = share_alike(actions, action_map(exact, agent, places, run.seed), _ALIKE)
            metrics, trials = assess(wrong, agent, run.seed, decisions=_DECISIONS)
        if run.agent != LEARNER:
            del row["known"], row["known_suitable"]  # they know no situations
        result = Result(run, row | metrics | {"level": error}, episode_rows(trials))
        if run.seed == 0:
            result.pictures["actions"] = actions
        return result

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Ask for similar maps, and for goals reached on them."""
        alike = float(np.median(column(results, "alike", "2 m")))
        reached = float(np.median(column(results, "success_rate", "2 m")))
        reason = (
            f"at ±2 m {alike:.0%} of the actions stay within 45° of the exact ones, and the goal "
            f"is reached from {reached:.0%} of unseen starts"
        )
        if alike >= 0.75 and reached >= 0.9:
            return Verdict("holds", reason)
        return Verdict("holds in part" if max(alike, reached) >= 0.75 else "does not hold", reason)

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show the way with the largest error."""
        run = Run(self.name, "2 m", LEARNER, study.config, study.room, study.robot, 0)
        agent, _ = trained_agent(run, folder)
        env = _open(run, ERRORS["2 m"])
        return Showcase(env, agent, spread_starts(env, 2), subtitle="odometry wrong by up to 2 m")
