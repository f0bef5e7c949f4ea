"""What the deep learners are trained with, found by a small search (docs/deep.md)."""

from dataclasses import dataclass
from math import inf
from numbers import Integral
from typing import ClassVar, Literal, TypeAlias

from nomad_mj.errors import ConfigError
from nomad_mj.limits import TINY, require

Algorithm = Literal["sac", "td3", "ppo"]
_SHARED = {
    "gamma": (0.0, 1.0),
    "learning_rate": (TINY, 1.0),
    "goal_bonus": (0.0, inf),
    "episode_decisions": (1.0, inf),
}


def _require_layers(hidden: tuple[int, ...]) -> None:
    if not hidden or any(not isinstance(units, Integral) or units < 1 for units in hidden):
        raise ConfigError(f"hidden {','.join(map(str, hidden))}: layers must have 1 unit or more")


@dataclass(frozen=True)
class _OffPolicy:
    """What SAC and TD3 have in common.

    Attributes
    ----------
    hidden : tuple of int
        Units of the hidden layers of every network.
    gamma : float
        Discount of a decision.
    learning_rate : float
        Of Adam, for all networks.
    batch_size : int
        Decisions that an update learns from.
    buffer_size : int
        Decisions that are remembered.
    learning_starts : int
        Decisions taken by chance before the first update.
    gradient_steps : int
        Updates after each decision.
    tau : float
        Share by which the target networks follow at each update.
    goal_bonus : float
        Reward for reaching the goal, beside z.
    episode_decisions : int
        An episode of training is given up after so many decisions.
    """

    hidden: tuple[int, ...] = (128, 128)
    gamma: float = 0.95
    learning_rate: float = 1e-3
    batch_size: int = 256
    buffer_size: int = 100_000
    learning_starts: int = 300
    gradient_steps: int = 1
    tau: float = 0.005
    goal_bonus: float = 2.0
    episode_decisions: int = 50

    def __post_init__(self) -> None:
        require(
            self,
            **_SHARED,
            batch_size=(1, inf),
            buffer_size=(1, inf),
            learning_starts=(0, inf),
            gradient_steps=(1, inf),
            tau=(0, 1),
        )
        _require_layers(self.hidden)


@dataclass(frozen=True)
class SacSettings(_OffPolicy):
    """Soft actor-critic (Haarnoja et al. 2018), with the entropy coefficient tuned by itself.

    Attributes
    ----------
    entropy : float
        Entropy coefficient to begin with.
    """

    algorithm: ClassVar[Algorithm] = "sac"
    entropy: float = 0.05

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self, entropy=(TINY, inf))


@dataclass(frozen=True)
class Td3Settings(_OffPolicy):
    """Twin delayed DDPG (Fujimoto et al. 2018).

    Attributes
    ----------
    exploration : float
        Standard deviation of the normal noise on actions while learning.
    """

    algorithm: ClassVar[Algorithm] = "td3"
    exploration: float = 0.3

    def __post_init__(self) -> None:
        super().__post_init__()
        require(self, exploration=(0, inf))


@dataclass(frozen=True)
class PpoSettings:
    """Proximal policy optimisation (Schulman et al. 2017).

    Attributes
    ----------
    hidden, gamma, learning_rate, batch_size, goal_bonus, episode_decisions
        As of SAC and TD3.
    rollout : int
        Decisions between two rounds of updates; what is left over at the end is not learnt from.
    epochs : int
        Passes over a rollout in a round of updates.
    gae_lambda : float
        Of generalised advantage estimation.
    spread : float
        Standard deviation of actions to begin with.
    """

    algorithm: ClassVar[Algorithm] = "ppo"
    hidden: tuple[int, ...] = (128, 128)
    gamma: float = 0.95
    learning_rate: float = 1e-3
    batch_size: int = 64
    rollout: int = 512
    epochs: int = 10
    gae_lambda: float = 0.95
    spread: float = 0.5
    goal_bonus: float = 2.0
    episode_decisions: int = 50

    def __post_init__(self) -> None:
        require(
            self,
            **_SHARED,
            batch_size=(2, inf),  # advantages are normalised within a batch
            rollout=(2, inf),
            epochs=(1, inf),
            gae_lambda=(0, 1),
            spread=(TINY, inf),
        )
        _require_layers(self.hidden)


DeepSettings: TypeAlias = SacSettings | Td3Settings | PpoSettings
LEARNERS: dict[str, type[DeepSettings]] = {
    made.algorithm: made for made in (SacSettings, Td3Settings, PpoSettings)
}
