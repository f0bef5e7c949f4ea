"""Fig 7: the action taken at a lattice of places all over the room."""

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
from nomad_agents.experiments.pictures import LATTICE, action_map, spread_starts
from nomad_agents.studies.runs import Result, Run

_SHOWN = 4


class Actions(Experiment):
    """Fig 7."""

    name = "fig7"
    title = "The action at every place"
    claim = "The situation-action rules cover the room: solution paths lead from any start."
    source = "section 4, Fig 7"
    table = (
        TableRow("share of places whose situation is known", "known", digits=3),
        TableRow("share of places with a suitable action", "suitable", digits=3),
        TableRow("share of suitable actions among the known", "known_suitable", digits=3),
        TableRow("categories that act somewhere", "acting"),
    )

    def runs(self, study: Study) -> list[Run]:
        """Return a run a seed, and some of the baselines."""
        return self.plan_runs(study, ("",), (STRAIGHT, PLANNER))

    def work(self, run: Run, folder: Path) -> Result:
        """Ask an agent what it does at each place."""
        with nomad_mj.load("path_finding", room=run.room, robot=run.robot) as env:
            agent = acting_agent(run, folder, env)
            actions = action_map(env, agent, lattice(env.scene, LATTICE), run.seed)
            result = Result(run, judge_actions(env, actions))
        if run.agent == LEARNER:
            result.row["acting"] = len({a["category"] for a in actions} - {-1})
        else:
            del result.row["known"], result.row["known_suitable"]  # they know no situations
        if run.seed == 0:
            result.pictures["actions"] = actions
        return result

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Ask for situations that are known, and for actions about as good as the planner's."""
        suitable = float(np.median(column(results, "suitable")))
        planner = float(np.median(column(results, "suitable", agent=PLANNER)))
        known = float(np.median(column(results, "known")))
        reason = (
            f"{known:.0%} of the situations are known; at {suitable:.0%} of the places the action "
            f"leads straight on along the shortest path, the planner's at {planner:.0%}"
        )
        claims = (known >= 0.9, suitable >= planner - 0.05)
        if all(claims):
            return Verdict("holds", reason)
        return Verdict("holds in part" if any(claims) else "does not hold", reason)

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show the trained robot from other starts than those of fig6, if there are any."""
        run = self.runs(study)[0]
        agent, _ = trained_agent(run, folder)
        env = nomad_mj.load("path_finding", room=run.room, robot=run.robot)
        starts = spread_starts(env, 2 * _SHOWN)
        return Showcase(env, agent, starts[_SHOWN:] or starts)
