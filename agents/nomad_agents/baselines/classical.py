"""What the classical agents have in common: they look for a way on the grid and remember it."""

from abc import abstractmethod
from typing import ClassVar, Generic, Protocol, TypeVar

import numpy as np

from nomad_agents.agent import Agent, Decision, DecisionKind
from nomad_agents.baselines.way import action_towards, longest_move, occupied_cells, reach_of
from nomad_agents.reactive_planner.config import ReactivePlannerConfig
from nomad_mj.perception import Percept
from nomad_mj.types import FloatArray, SensorLayout

NEAR = 1e-6  # [m] from a point: there is no direction to it
BLOCKED = 0.02  # [m] no move is worth making that is shorter


class ClassicalConfig(Protocol):
    """What the settings of all classical agents hold."""

    @property
    def safety(self) -> float:
        """Distance to keep from the centres of occupied cells, beside the robot's radius [m]."""
        ...

    @property
    def occupied(self) -> float:
        """Above this probability a cell is in the way."""
        ...


Config = TypeVar("Config", bound=ClassicalConfig)


class ClassicalAgent(Agent, Generic[Config]):
    """Chooses each move from the certainty grid and the direction of the last move.

    Parameters
    ----------
    layout : SensorLayout
        The robot's sensors.
    planner : ReactivePlannerConfig
        Of it, what percepts are made of and the limits of a move.
    config : Config
        Settings of the method.

    Attributes
    ----------
    kind : "reacted" or "planned"
        What its decisions are called.
    action : ActionSpec
        Limits of a move.
    config : Config
        As given.
    """

    kind: ClassVar[DecisionKind] = "reacted"

    def __init__(
        self, layout: SensorLayout, planner: ReactivePlannerConfig, config: Config
    ) -> None:
        super().__init__(layout, planner.situation)
        self.action = planner.action
        self.config = config
        self._reach = reach_of(layout, config.safety)
        self._last: float | None = None  # direction of the last move [rad]

    def start_episode(self, chance: np.random.Generator | None = None) -> None:
        """Forget the direction of the last move."""
        self._last = None

    def act(self, percept: Percept, explore: np.random.Generator | None) -> Decision:
        """Return the move that the method chooses."""
        goal = percept.goal
        longest = longest_move(goal, self.action)
        if longest < NEAR:
            return Decision(np.array([1.0, 0.0]), self.kind)
        heading, length = self._choose(percept, longest)
        self._last = heading
        return Decision(action_towards(heading, length, goal, self.action), self.kind)

    @abstractmethod
    def _choose(self, percept: Percept, longest: float) -> tuple[float, float]:
        """Return the direction [rad] and the length [m] of the next move, of at most `longest`."""

    def _occupied(self, percept: Percept) -> FloatArray:
        """Return the centres (n, 2) of the cells that are in the way [m], from the robot."""
        return occupied_cells(percept, self.situation.grid, self.config.occupied)
