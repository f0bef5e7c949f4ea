"""The reactive planner's planner alone: it plans at every decision and learns nothing."""

import numpy as np

from nomad_agents.agent import Agent, Decision
from nomad_agents.reactive_planner.config import ReactivePlannerConfig
from nomad_agents.reactive_planner.planner import plan
from nomad_mj.perception import Percept
from nomad_mj.types import SensorLayout


class Planner(Agent):
    """Asks the reactive planner's planner at every decision."""

    name = "planner"

    def __init__(self, layout: SensorLayout, config: ReactivePlannerConfig) -> None:
        super().__init__(layout, config.situation)
        self.config = config

    def act(self, percept: Percept, explore: np.random.Generator | None) -> Decision:
        """Return the best of the planner's 80 actions."""
        config = self.config
        best = plan(
            percept, self.layout.radius, config.situation.grid, config.action, config.planner
        )
        return Decision(best.action, "planned")
