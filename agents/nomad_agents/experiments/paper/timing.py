"""How long a reaction and a planning take, and how that grows with the number of exemplars."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

import nomad_mj
from nomad_agents.experiments.experiment import (
    Experiment,
    Showcase,
    Study,
    TableRow,
    Verdict,
    column,
)
from nomad_agents.experiments.learnt import trained_agent
from nomad_agents.experiments.pictures import spread_starts
from nomad_agents.registry import find_config
from nomad_agents.speed.ratios import decision_times
from nomad_agents.studies.runs import Result, Run

EXEMPLARS = (10, 30, 100, 300, 1000, 3000)
PAPER_REACTION_S, PAPER_PLANNING_S = 0.04, 1.6
_SEEDS = 3  # clocks differ little


class Timing(Experiment):
    """The times of section 4."""

    name = "timing"
    title = "Time of a decision"
    claim = "A reaction takes 0.04 s, a planning 1.6 s, on a SparcStation 2."
    source = "section 4"
    needs_trained, shows_trained = False, True
    table = (
        *(
            TableRow(f"reaction with {n} exemplars, ms", f"reaction_{n}_ms",
                     paper="40" if n == 100 else "", digits=3)
            for n in EXEMPLARS
        ),
        *(
            TableRow(f"planning with {n} exemplars, ms", f"planning_{n}_ms",
                     paper="1600" if n == 100 else "", digits=3)
            for n in EXEMPLARS
        ),
    )  # fmt: skip

    def runs(self, study: Study) -> list[Run]:
        """Return a few runs, one after another as the others are."""
        return self.plan_runs(study, ("",), ())[:_SEEDS]

    def work(self, run: Run, folder: Path) -> Result:
        """Measure; times are this machine's, and differ from run to run."""
        result = Result(run, {})
        reactions: list[list[float]] = []
        plannings: list[list[float]] = []
        for count in EXEMPLARS:
            reaction, planning = decision_times(
                run.room, run.robot, find_config(run.config), exemplars=count
            )
            reactions.append([count, reaction])
            plannings.append([count, planning])
            result.row[f"reaction_{count}_ms"] = 1000 * reaction
            result.row[f"planning_{count}_ms"] = 1000 * planning
        result.pictures = {"reactions": reactions, "plannings": plannings}
        return result

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Compare the two; a machine of today is faster than the paper's in any case."""
        reaction, planning = (
            float(np.median(column(results, f"{kind}_100_ms"))) for kind in ("reaction", "planning")
        )
        reason = (
            f"with 100 exemplars a reaction takes {reaction:.2f} ms, a planning {planning:.2f} ms: "
            f"{planning / reaction:.1f} times as long; in the paper 40 times"
        )
        faster = reaction <= 1000 * PAPER_REACTION_S and planning <= 1000 * PAPER_PLANNING_S
        return Verdict("holds" if faster else "does not hold", reason)

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show the agent whose decisions are timed."""
        run = self.runs(study)[0]
        agent, _ = trained_agent(run, folder)
        env = nomad_mj.load("path_finding", room=run.room, robot=run.robot)
        return Showcase(env, agent, spread_starts(env, 1))
