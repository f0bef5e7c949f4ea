"""Agents whose only module is known."""

from dataclasses import replace
from typing import Any

import numpy as np
from nomad_agents.reactive_planner import FAITHFUL, ReactivePlanner

from nomad_mj.perception import Percept
from nomad_mj.types import FloatArray, SensorLayout


def knowing(
    layout: SensorLayout, percept: Percept, value: float = -3.0, **parameters: Any
) -> ReactivePlanner:
    """Return an agent with one category, (0.5, -0.25), and one exemplar, here."""
    agent = ReactivePlanner(layout, replace(FAITHFUL, **parameters))
    agent.network.add_exemplar(
        percept.situation, agent.network.add_category(np.array([0.5, -0.25]), value)
    )
    return agent


def shifted(percept: Percept, by: float) -> Percept:
    """Return the percept with a situation so far away."""
    situation = percept.situation.copy()
    situation[0] += by
    return percept._replace(situation=situation)


def output(prototype: FloatArray, level: FloatArray) -> FloatArray:
    """Return Eqs 11 and 16."""
    return np.clip(prototype + 4 / (1 + np.exp(-0.4 * level)) - 2, -1, 1)
