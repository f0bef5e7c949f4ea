"""Straight to the goal: what a robot can do that looks at nothing."""

import numpy as np

from nomad_agents.agent import Agent, Decision
from nomad_agents.reactive_planner.config import ReactivePlannerConfig
from nomad_mj.perception import Percept
from nomad_mj.types import SensorLayout


class Straight(Agent):
    """Goes straight to the goal, whatever is in the way."""

    name = "straight"

    def __init__(self, layout: SensorLayout, config: ReactivePlannerConfig) -> None:
        super().__init__(layout, config.situation)

    def act(self, percept: Percept, explore: np.random.Generator | None) -> Decision:
        """Return the move towards the goal."""
        return Decision(np.array([1.0, 0.0]), "reacted")
