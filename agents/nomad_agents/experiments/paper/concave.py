"""Fig 13: out of a concave obstacle, with and without the memory of good actions."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

import nomad_mj
from nomad_agents.agent import Agent
from nomad_agents.evaluation import evaluate, run_trial
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
from nomad_agents.experiments.pictures import Way, way
from nomad_agents.registry import find_config
from nomad_agents.studies.measures import DECISIONS, episode_rows
from nomad_agents.studies.runs import Result, Run
from nomad_agents.training import TrainingConfig, test_stream
from nomad_mj.arenas import Geodesic
from nomad_mj.envs import PathFinding

ROOM = "concave_room"
START = 0  # the one in the concave side
MEMORY = {"with memory": True, "without memory": False}
ENOUGH = 2600  # reactions; the paper's 2547, rounded
AGAIN = 5  # episodes after the learning
LIMIT = 6000  # decisions after which a run is given up
_PAPER = {
    "learn_reactions": ("2547", "about 20 000"),
    "learn_plannings": ("716", ""),
    "learn_virtual_collisions": ("282", ""),
    "learn_categories": ("55", ""),
    "learn_exemplars": ("154", ""),
}


def _rows(case: str, which: int) -> tuple[TableRow, ...]:
    counts = (
        ("reactions until then", "learn_reactions"),
        ("plannings", "learn_plannings"),
        ("virtual collisions", "learn_virtual_collisions"),
        ("categories", "learn_categories"),
        ("exemplars", "learn_exemplars"),
    )
    return (
        TableRow(f"{case}: runs that find the way", "learn_solved_all", case, "1 of 1", total=True),
        TableRow(f"{case}: in {ENOUGH} reactions or fewer", "soon", case, total=True),
        *(TableRow(f"{case}: {text}", key, case, _PAPER[key][which]) for text, key in counts),
    )


def _reactions(results: Sequence[Result], case: str) -> dict[int, float]:
    """Return the reactions that learning took, by seed."""
    return {
        result.run.seed: float(result.row["learn_reactions"])
        for result in results
        if result.run.case == case and result.run.agent == LEARNER
    }


def _open(run: Run) -> PathFinding:
    return nomad_mj.load("path_finding", room=run.room, robot=run.robot)


class Concave(Experiment):
    """Fig 13."""

    name = "fig13"
    title = "Out of a concave obstacle"
    claim = (
        "With the memory of good actions the way out of a concave obstacle is learnt in 2547 "
        "reactions; without it, it took about 20 000."
    )
    source = "section 5, Fig 13"
    needs_trained = False
    table = (
        *_rows("with memory", 0),
        *_rows("without memory", 1),
        *(
            TableRow(f"{case}: goal reached again, greedy, with other noise", "again", case, "", 2)
            for case in MEMORY
        ),
    )

    def runs(self, study: Study) -> list[Run]:
        """Return a run with and without memory for each seed, and some of the baselines."""
        memory, without = MEMORY
        runs = self.plan_runs(study, list(MEMORY), (STRAIGHT, PLANNER), ROOM, costly=(without,))
        # The baselines remember nothing.
        return [run for run in runs if run.agent == LEARNER or run.case == memory]

    def work(self, run: Run, folder: Path) -> Result:
        """Learn the way from the one start, then show it."""
        result = Result(run, {})
        with _open(run) as env:
            if run.agent == LEARNER:
                config = find_config(run.config)
                config = replace(config, remember_good_actions=MEMORY[run.case])
                settings = TrainingConfig(
                    run.seed, max_passes=LIMIT, max_decisions=LIMIT, starts=(START,)
                )
                agent = new_learner(result, folder, env, config, settings)
                row = result.row
                row["soon"] = row["learn_solved_all"] and row["learn_reactions"] <= ENOUGH
                found = test_stream(settings, row["learn_passes"], 0)
            else:
                agent = acting_agent(run, folder, env)
                found = test_stream(TrainingConfig(run.seed), 1, 0)
            starts = env.scene.arena.starts[[START] * AGAIN]
            trials = evaluate(env, agent, starts, run.seed, DECISIONS)
            result.row["again"] = float(np.mean([trial.episode.reached for trial in trials]))
            result.episodes = episode_rows(trials)
            if run.seed == 0:
                result.pictures = {"ways": [self._way(env, agent, found)], "room": run.room}
        return result

    @staticmethod
    def _way(env: PathFinding, agent: Agent, seed: np.random.SeedSequence) -> Way:
        """Return the way of the test that ended the learning."""
        scene = env.scene
        geodesic = Geodesic(scene.plan, scene.arena.goal, scene.robot.layout.radius)
        return way(run_trial(env, agent, START, seed, DECISIONS, geodesic))

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Ask for the paper's number of reactions, and that the memory helps."""
        soon = column(results, "soon", "with memory")
        with_memory, without = (
            float(np.median(column(results, "learn_reactions", case))) for case in MEMORY
        )
        # Without memory fewer seeds are run: only the same ones can be compared.
        remembering, forgetting = (_reactions(results, case) for case in MEMORY)
        both = remembering.keys() & forgetting.keys()
        times = float(np.median([forgetting[seed] / max(remembering[seed], 1.0) for seed in both]))
        reason = (
            f"with memory {int(soon.sum())} of {len(soon)} runs find the way in {ENOUGH} reactions "
            f"or fewer, {with_memory:.0f} in the median; without it {without:.0f}, "
            f"{times:.1f} times as many with the same {len(both)} seeds"
        )
        if soon.mean() >= 0.85:
            return Verdict("holds" if times > 2 else "holds in part", reason)
        return Verdict("holds in part" if soon.mean() >= 0.5 else "does not hold", reason)

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show the way out."""
        run = Run(self.name, "with memory", LEARNER, study.config, ROOM, study.robot, 0)
        return Showcase(_open(run), kept_agent(run, folder), [START], subtitle="with memory")
