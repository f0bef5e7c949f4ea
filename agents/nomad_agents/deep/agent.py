"""A deep learner's policy as an agent: numpy is all it needs to drive, be measured and filmed."""

import numpy as np

from nomad_agents.agent import Agent, Decision
from nomad_agents.deep.policy import Policy
from nomad_agents.deep.settings import DeepSettings
from nomad_mj.perception import Observation, Percept, SituationSpec, code_percept, coded_size
from nomad_mj.types import SensorLayout


class DeepAgent(Agent):
    """Acts by a network that SAC, TD3 or PPO has trained; it learns no more.

    Its actions are those of Stable-Baselines3's ``predict(deterministic=True)`` to rounding.

    Parameters
    ----------
    layout : SensorLayout
        The sensors it was trained with.
    situation : SituationSpec
        How it wants its percepts.
    observation : "situation" or "ranges"
        What of a percept the network is shown.
    policy : Policy
        The network.
    settings : SacSettings, Td3Settings or PpoSettings
        What it was trained with.

    Raises
    ------
    ValueError
        A network with other inputs or outputs.
    """

    def __init__(
        self,
        layout: SensorLayout,
        situation: SituationSpec,
        observation: Observation,
        policy: Policy,
        settings: DeepSettings,
    ) -> None:
        super().__init__(layout, situation)
        wanted = coded_size(layout, observation, situation.size), 2
        if (policy.inputs, policy.outputs) != wanted:
            raise ValueError(
                f"a network from {policy.inputs} to {policy.outputs} numbers, not {wanted}"
            )
        self.name = settings.algorithm
        self.observation: Observation = observation
        self.policy = policy
        self.settings = settings

    def act(self, percept: Percept, explore: np.random.Generator | None) -> Decision:
        """Return the network's action; it explores only in its own training, never here."""
        shown = code_percept(percept, self.layout, self.observation)
        return Decision(self.policy(shown).astype(np.float64), "reacted")
