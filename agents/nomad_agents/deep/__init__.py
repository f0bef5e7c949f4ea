"""Deep learners to compare with: Stable-Baselines3's SAC, TD3 and PPO.

What is imported here drives without PyTorch; `deep.training` needs it.
"""

from nomad_agents.deep.agent import DeepAgent
from nomad_agents.deep.policy import Policy
from nomad_agents.deep.settings import (
    LEARNERS,
    DeepSettings,
    PpoSettings,
    SacSettings,
    Td3Settings,
)

__all__ = [
    "LEARNERS",
    "DeepAgent",
    "DeepSettings",
    "Policy",
    "PpoSettings",
    "SacSettings",
    "Td3Settings",
]
