"""The reactive planner: react where a situation is known, plan where it is not, learn from both.

Source: section 3 of the paper; the three learning situations are those of section 3.3.2.
"""

import math
from typing import NamedTuple

import numpy as np

from nomad_agents.agent import Agent, Decision, DecisionKind
from nomad_agents.reactive_planner.config import ReactivePlannerConfig
from nomad_agents.reactive_planner.network import Match, Network
from nomad_agents.reactive_planner.planner import Plan, estimate_value, plan
from nomad_mj.perception import Percept
from nomad_mj.types import FloatArray, SensorLayout

_GOOD = 0.1  # section 5: an action this much better than |b_j| is worth remembering
_HERE: FloatArray = np.zeros((1, 2))


class _Step(NamedTuple):
    """What the backup at the goal needs of a step."""

    category: int
    action: FloatArray
    reward: float


class ReactivePlanner(Agent):
    """The paper's agent.

    Parameters
    ----------
    layout : SensorLayout
        The robot's sensors.
    config : ReactivePlannerConfig
        Parameters.

    Attributes
    ----------
    network : Network
        What has been learnt.
    plannings : int
        How often the planner was called while learning.
    """

    name = "reactive_planner"

    def __init__(self, layout: SensorLayout, config: ReactivePlannerConfig) -> None:
        super().__init__(layout, config.situation)
        self.config = config
        self.network = Network(config.situation.size)
        self.plannings = 0
        self._path: list[_Step] = []

    def start_episode(self, chance: np.random.Generator | None = None) -> None:
        """Forget the path of the episode before."""
        self._path.clear()

    def _classify(self, percept: Percept) -> Match:
        return self.network.classify(percept.situation, self.config.k_dist, self.config.k_ind)

    def act(self, percept: Percept, explore: np.random.Generator | None) -> Decision:
        """Categorise the situation and react; plan first where nothing matches (situation 1)."""
        match, unmatched = self._classify(percept), False
        kind: DecisionKind = "reacted"
        if match.category < 0:
            if explore is not None:
                self._plan_category(percept)
                match, kind = self._classify(percept), "planned"
            elif self.config.no_match == "plan":
                return Decision(self._plan(percept).action, "planned", unmatched=True)
            elif self.config.no_match == "nearest" and len(self.network.category):
                match, unmatched = self.network.nearest(percept.situation), True
            else:
                return Decision(np.zeros(2), "none", unmatched=True)
        network, j = self.network, match.category
        mine = network.category == j
        mean = match.activation[mine] @ network.weights[mine]  # Eq 12
        drawn = mean
        if explore is not None:
            drawn = explore.normal(mean, self._sigma(j))  # Eq 15
        action = self._output(j, drawn)
        return Decision(action, kind, j, drawn, mean, unmatched)

    def _output(self, category: int, level: FloatArray) -> FloatArray:
        """Return the action units' output (Eqs 11 and 16)."""
        swing = 4.0 / (1.0 + np.exp(-self.config.beta * level)) - 2.0
        return np.clip(self.network.prototype[category] + swing, -1.0, 1.0)

    def _sigma(self, category: int) -> float:
        """Return the breadth of exploration (Eq 13)."""
        trace = float(self.network.trace[category])
        return max(self.config.k_sigma * trace, self.config.sigma_floor)

    def _plan(self, percept: Percept) -> Plan:
        config = self.config
        return plan(
            percept, self.layout.radius, config.situation.grid, config.action, config.planner
        )

    def _plan_category(self, percept: Percept, instead_of: int = -1) -> None:
        """Plan and store the situation as an exemplar of the category that the plan belongs to.

        Nothing is stored if that is `instead_of`: it has just been tried.
        """
        self.plannings += 1
        action, value = self._plan(percept)
        category = self.network.find_category(action, value, self.config.k_z)
        if category < 0:
            category = self.network.add_category(action, value)
        if category != instead_of:
            self.network.add_exemplar(percept.situation, category)

    def learn(
        self, percept: Percept, decision: Decision, reward: float, collided: bool, after: Percept
    ) -> None:
        """Learn from a step: tune the module that acted, or categorise the situation again."""
        match = self._classify(after)
        if match.category >= 0:
            promise = float(self.network.value[match.category])
        else:
            grid, planner = self.config.situation.grid, self.config.planner
            promise = float(estimate_value(_HERE, after, grid, planner)[0])
        self._update(percept, decision, reward, promise, collided)

    def reach_goal(self, percept: Percept, decision: Decision, reward: float) -> None:
        """Learn from the last step, then back the values up along the path in reverse order."""
        self._update(percept, decision, reward, 0.0, collided=False)
        promise = float(self.network.value[decision.category])
        for step in reversed(self._path[:-1]):
            error = step.reward + promise - float(self.network.value[step.category])
            self._remember(step.category, step.action, error)
            self._adjust_value(step.category, error)
            promise = float(self.network.value[step.category])

    def _update(
        self, percept: Percept, decision: Decision, reward: float, promise: float, collided: bool
    ) -> None:
        """Learning situations 2 and 3."""
        j, network = decision.category, self.network
        self._path.append(_Step(j, decision.action, reward))
        error = reward + promise - float(network.value[j])
        xi = self.config.xi
        network.trace[j] = xi * abs(error) + (1 - xi) * network.trace[j]  # Eq 14
        if not collided:
            self._remember(j, decision.action, error)
        if error >= -self.config.k_z and not collided:
            self._tune(percept, decision, error)
            self._adjust_value(j, error)
        else:  # the value must fall too, else the bad category wins for ever
            self._adjust_value(j, min(error, 0.0) if collided else error)
            self._plan_category(percept, instead_of=j)

    def _adjust_value(self, category: int, error: float) -> None:
        """TD(0), Eq 18."""
        eta = self.config.eta_reward if error > 0 else self.config.eta_penalty
        self.network.value[category] += eta * error

    def _tune(self, percept: Percept, decision: Decision, error: float) -> None:
        """Move the active exemplars and the weights of the module that acted (Eqs 21-23)."""
        network, config, j = self.network, self.config, decision.category
        mine = np.flatnonzero(network.category == j)
        off = percept.situation - network.situation[mine]
        distance = np.sqrt(np.einsum("ij,ij->i", off, off))
        a = np.where(distance < config.k_dist, np.exp(-distance), 0.0)[:, None]
        network.situation[mine] += config.epsilon * a * off
        if config.remember_good_actions and error <= 0:
            taught = network.best_action[j] - self._output(j, decision.mean)
            network.weights[mine] += config.alpha_reward * a * taught  # LMS
            return
        alpha = config.alpha_reward if error > 0 else config.alpha_penalty
        # The breadth is the one after this error was taken in: with the one that the action was
        # drawn with the quotient explodes.
        eligibility = a * (decision.drawn - decision.mean) / self._sigma(j) ** 2
        network.weights[mine] += alpha * error * eligibility

    def _remember(self, category: int, action: FloatArray, error: float) -> None:
        """Keep an action that did much better than expected (section 5)."""
        if error > _GOOD * math.fabs(float(self.network.value[category])):
            self.network.best_action[category] = action
