"""Training of a deep learner with Stable-Baselines3, for a budget of decisions.

PyTorch and Stable-Baselines3 are imported when training begins, not before. Both draw from global
generators and have global settings; they are put back as they were.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium

from nomad_agents.deep.agent import DeepAgent
from nomad_agents.deep.extra import require_extra
from nomad_agents.deep.settings import DeepSettings, PpoSettings
from nomad_mj.errors import ConfigError


@dataclass
class DeepTraining:
    """How far a deep training is, all of it while learning.

    Attributes
    ----------
    decisions, episodes : int
        Moves made, those by chance at first included; episodes that have ended.
    reached : int
        Episodes that ended at the goal.
    virtual_collisions, bumper_contacts : int
        Moves that ended so; moves in which something was touched.
    sim_s : float
        Simulated time [s].
    """

    decisions: int = 0
    episodes: int = 0
    reached: int = 0
    virtual_collisions: int = 0
    bumper_contacts: int = 0
    sim_s: float = 0.0


Evaluate = Callable[[DeepAgent, int, float], None]


def train_deep(
    settings: DeepSettings,
    env: "gymnasium.Env[Any, Any]",
    seed: int,
    decisions: int,
    every: int = 0,
    evaluate: Evaluate | None = None,
    *,
    training: DeepTraining | None = None,
    after_decision: Callable[[DeepTraining], None] | None = None,
    log_folder: Path | None = None,
) -> DeepAgent:
    """Train a new agent and return it.

    The same arguments give the same bits on the same machine with the same versions of the
    packages, whatever `every` and `evaluate` are. An interrupted training cannot go on: memory,
    optimisers and the episode under way would have to be kept for it.

    Parameters
    ----------
    settings : SacSettings, Td3Settings or PpoSettings
        The algorithm and its parameters.
    env : gymnasium.Env
        `nomad_mj/PathFinding-v0` as `make_env` makes it.
    seed : int
        Of all randomness, that of `env` included.
    decisions : int
        Moves to learn from, those taken by chance at first included.
    every : int
        Call `evaluate` each time so many more have been made; 0 for only at the end.
    evaluate : callable, optional
        Called with the agent as it is then, the decisions made and the time simulated so far [s].
        It must leave `env` alone; what it raises ends the training.
    training : DeepTraining, optional
        Brought up to date after every decision.
    after_decision : callable, optional
        Called with it; what it raises ends the training.
    log_folder : Path, optional
        Where Stable-Baselines3 writes curves for TensorBoard; those of a training before are
        deleted.

    Raises
    ------
    ConfigError
        PyTorch or Stable-Baselines3 is not installed; an option that makes no sense.
    OutputError
        `log_folder` cannot be written.
    """
    require_budget(decisions, every, seed, settings)
    require_extra(curves=log_folder is not None)
    from nomad_agents.deep.learner import Learner  # takes seconds: it imports PyTorch

    training = DeepTraining() if training is None else training

    def report(agent: DeepAgent) -> None:
        if evaluate is not None:
            evaluate(agent, training.decisions, training.sim_s)

    with Learner(settings, env, seed, log_folder) as learner:
        learner.learn(decisions, every or decisions, training, after_decision, report)
        return learner.agent()


def require_budget(decisions: int, every: int, seed: int, settings: DeepSettings) -> None:
    """Raise ConfigError unless `train_deep` takes these numbers."""
    if isinstance(settings, PpoSettings) and 1 <= decisions < settings.rollout:
        raise ConfigError(
            f"decisions {decisions}: PPO learns nothing from fewer than its rollout of "
            f"{settings.rollout}"
        )
    for name, given, least in (("decisions", decisions, 1), ("every", every, 0), ("seed", seed, 0)):
        if given < least:
            raise ConfigError(f"{name} {given}: must be {least} or more")
    if seed >= 2**32:
        raise ConfigError(f"seed {seed}: must be below 2**32, for PyTorch")
