"""Moves at random: what a robot can do that knows nothing."""

import numpy as np

from nomad_agents.agent import Agent, Decision
from nomad_agents.reactive_planner.config import ReactivePlannerConfig
from nomad_mj.perception import Percept
from nomad_mj.types import SensorLayout


class RandomMoves(Agent):
    """Draws every action uniformly from the square of all actions.

    It draws from the episode's own stream, so that an episode repeats itself to the bit.
    """

    name = "random"

    def __init__(self, layout: SensorLayout, config: ReactivePlannerConfig) -> None:
        super().__init__(layout, config.situation)
        self.start_episode()

    def start_episode(self, chance: np.random.Generator | None = None) -> None:
        """Draw from this stream from now on; without one, from that of seed 0."""
        self._chance = np.random.default_rng(0) if chance is None else chance

    def act(self, percept: Percept, explore: np.random.Generator | None) -> Decision:
        """Return an action drawn at random."""
        return Decision(self._chance.uniform(-1.0, 1.0, 2), "reacted")
