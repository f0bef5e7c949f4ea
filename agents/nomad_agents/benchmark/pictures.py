"""Which figures a benchmark has, drawn from its results alone."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from nomad_agents.benchmark.efficiency import Efficiency, sample_efficiency
from nomad_agents.benchmark.figures import draw_efficiency, draw_intervals, draw_profiles
from nomad_agents.benchmark.numbers import Group, run_of, spread_of, strata
from nomad_agents.benchmark.page import Figure
from nomad_agents.benchmark.profiles import performance_profile

_THRESHOLDS = np.linspace(0.0, 1.0, 101)
_SCORES = {"spl": "SPL", "success_rate": "share of goals reached"}


def draw_all(groups: Sequence[Group], folder: Path) -> list[Figure]:
    """Draw how all agents do in all sets: intervals and performance profiles.

    Raises
    ------
    OutputError
        A figure cannot be written.
    """
    figures: list[Figure] = []
    for key, score in _SCORES.items():
        path = folder / f"intervals_{key}"
        spreads = {
            group.name: {agent: spread_of(held, key) for agent, held in group.agents.items()}
            for group in groups
        }
        draw_intervals(spreads, path, score)
        figures.append(
            Figure(path, f"Interquartile mean of the {score} by set, with its 95 % interval.")
        )
    path = folder / "profiles_spl"
    profiles = {
        group.name: {
            agent: performance_profile(strata(held, "spl"), _THRESHOLDS)
            for agent, held in group.agents.items()
        }
        for group in groups
    }
    draw_profiles(profiles, path, "SPL of a run")
    caption = (
        "Performance profiles: the share of runs, over rooms and seeds, whose SPL is above a "
        "threshold, with 95 % bands. The higher and the farther to the right, the better."
    )
    return [*figures, Figure(path, caption)]


def draw_learning(group: Group, folder: Path) -> list[Figure]:
    """Draw the sample efficiency of a set of which whole curves are there.

    Raises
    ------
    OutputError
        The figure cannot be written.
    """
    curves: dict[str, Efficiency] = {}
    unaided: dict[str, Efficiency] = {}
    levels: dict[str, float] = {}
    for agent, held in group.agents.items():
        if not run_of(held[0]).whole_curves:
            continue
        curve, alone = sample_efficiency(held), sample_efficiency(held, "unaided_")
        if curve is None:
            levels[agent] = spread_of(held, "success_rate").iqm
            continue
        curves[agent] = curve
        if alone is not None:
            unaided[agent] = alone
    if not curves:
        return []
    path = folder / ("efficiency_" + re.sub(r"[^A-Za-z0-9.]+", "-", group.name))
    draw_efficiency(curves, unaided, levels, path, f"Sample efficiency, {group.name}")
    caption = (
        "How many unseen starts an agent solves after so many decisions of learning: the median "
        "over runs, a band between the quartiles, and a mark at the median of decisions until "
        "90 %. Dotted: agents that do not learn. What was there before learning begins at the "
        "left edge."
    )
    return [Figure(path, caption)]
