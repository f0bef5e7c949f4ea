"""Figures that show numbers over runs: learning, cases, variants, times."""

import numpy as np

from nomad_agents.experiments.experiment import LEARNER, PLANNER, STRAIGHT, Experiment, column
from nomad_agents.experiments.figures.cases import Shares, draw_cases
from nomad_agents.experiments.figures.learning_curve import draw_learning
from nomad_agents.experiments.figures.timing import draw_timing
from nomad_agents.experiments.figures.variants import Measure, draw_variants
from nomad_agents.experiments.illustrate.material import Illustration, Material
from nomad_agents.studies.statistics import spread
from nomad_mj.types import FloatArray

_AGENTS = {LEARNER: "ours", STRAIGHT: "straight to the goal", PLANNER: "planner at every decision"}
_SHARES = {
    "success_rate": "goal reached",
    "strict_success_rate": "without any virtual collision",
}


def learning(material: Material) -> list[Illustration]:
    """Draw what learning has brought and has cost."""
    own = [each for each in material.results if each.run.agent == LEARNER and each.curve]
    groups = {case: [r.curve for r in own if r.run.case == case] for case in material.cases}
    groups = {case: curves for case, curves in groups.items() if curves}
    if not groups:
        return []
    path = material.path("learning")
    draw_learning(groups, path, material.experiment.title, _paper_points(material.experiment))
    caption = (
        "Starts solved, and what it cost, against reactions: each run, and their median, in which "
        "a run that is done stays as it ended."
    )
    return [Illustration(path, caption)]


def _paper_points(experiment: Experiment) -> dict[str, tuple[float, float]]:
    """Return where the paper's one run ended, in the panels of `draw_learning`."""
    said: dict[str, float] = {}
    for row in experiment.table:
        if row.paper.isdecimal():
            said.setdefault(row.key.removeprefix("learn_"), float(row.paper))
    if "reactions" not in said:
        return {}
    said["solved"] = 100.0
    keys = ("solved", "virtual_collisions", "plannings")
    return {key: (said["reactions"], said[key]) for key in keys if key in said}


def cases(material: Material) -> list[Illustration]:
    """Draw how well all agents do in each case."""
    measures: list[Shares] = []
    for key, label in _SHARES.items():
        agents = {
            name: {
                case: over
                for case in material.cases
                if (over := spread([column(material.results, key, case, agent)])).count
            }
            for agent, name in _AGENTS.items()
        }
        measures.append(Shares(label, {name: held for name, held in agents.items() if held}))
    measures = [measure for measure in measures if measure.agents]
    if not measures:
        return []
    path = material.path("cases")
    joined = material.experiment.name == "fig8"  # its cases are sizes of one error
    draw_cases(measures, path, material.experiment.title, joined=joined)
    caption = "Episodes from unseen starts: interquartile mean over runs, 95 % interval."
    return [Illustration(path, caption)]


def timing(material: Material) -> list[Illustration]:
    """Draw what a decision takes."""
    reactions, plannings = (
        [pair for result in material.results for pair in result.pictures.get(key, [])]
        for key in ("reactions", "plannings")
    )
    if not reactions and not plannings:
        return []
    path = material.path("times")
    draw_timing(reactions, plannings, path, material.experiment.title)
    return [Illustration(path, "What a decision takes, against the exemplars that are known.")]


def variants(material: Material) -> list[Illustration]:
    """Draw what each variant of the agent takes and reaches."""
    reactions: dict[str, FloatArray] = {}
    strict: dict[str, FloatArray] = {}
    for case in material.cases:
        solved, taken, rate = (
            column(material.results, key, case)
            for key in ("learn_solved_all", "learn_reactions", "strict_success_rate")
        )
        if len(solved) == len(taken) > 0:
            reactions[case] = np.where(solved > 0, taken, np.nan)
        if len(rate):
            strict[case] = 100 * rate
    measures = [
        Measure("reactions until every start is solved", reactions),
        Measure("unseen starts without collision [%]", strict),
    ]
    measures = [measure for measure in measures if measure.runs]
    if not measures:
        return []
    path = material.path("variants")
    draw_variants(measures, path, material.experiment.title)
    caption = (
        "Each run, interquartile mean and 95 % interval; beside a line, in how many runs every "
        "start is solved if not in all."
    )
    return [Illustration(path, caption)]
