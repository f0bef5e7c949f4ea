"""Stable-Baselines3's learners behind our settings, and their actors as our policies."""

import math
import random
from collections.abc import Callable, Generator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import torch
from stable_baselines3 import PPO, SAC, TD3
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger, configure
from stable_baselines3.common.noise import NormalActionNoise
from torch import nn
from typing_extensions import Self

from nomad_agents.curves import curves_folder
from nomad_agents.deep.agent import DeepAgent
from nomad_agents.deep.environment import task_of
from nomad_agents.deep.policy import Policy
from nomad_agents.deep.settings import DeepSettings, PpoSettings, Td3Settings
from nomad_agents.deep.training import DeepTraining
from nomad_mj.motion import Outcome


class Learner:
    """A learner and its environment; a context, in which PyTorch is set up for it.

    Parameters
    ----------
    settings, env, seed, log_folder
        As of `training.train_deep`.
    """

    def __init__(
        self,
        settings: DeepSettings,
        env: "gymnasium.Env[Any, Any]",
        seed: int,
        log_folder: Path | None = None,
    ) -> None:
        self._settings = settings
        self._env = env
        self._seed = seed
        self._log_folder = log_folder

    def __enter__(self) -> Self:
        task_of(self._env)
        with ExitStack() as stack:
            stack.enter_context(_own_chance())
            stack.enter_context(_one_thread())
            self.model = make_model(self._settings, self._env, self._seed)
            logger = Logger(None, [])
            if self._log_folder is not None:
                with curves_folder(self._log_folder, resume=False) as folder:
                    logger = configure(str(folder), ["tensorboard"])
            self.model.set_logger(logger)
            stack.callback(logger.close)
            self._stack = stack.pop_all()
        return self

    def __exit__(self, *error: object) -> None:
        self._stack.close()

    def agent(self) -> DeepAgent:
        """Return the agent as it is now; it does not change when learning goes on."""
        task = task_of(self._env)
        layout, policy = task.task.scene.robot.layout, policy_of(self.model)
        observation = "ranges" if task.observation == "ranges" else "situation"
        return DeepAgent(layout, task.situation, observation, policy, self._settings)

    def learn(
        self,
        decisions: int,
        every: int,
        training: DeepTraining,
        after_decision: Callable[[DeepTraining], None] | None,
        report: Callable[[DeepAgent], None],
    ) -> None:
        """Learn from so many decisions; call `report` each time `every` more have been made."""
        # PPO learns when a rollout is over: from one that is over with the budget, too.
        learns_last = isinstance(self._settings, PpoSettings) and (
            decisions % self._settings.rollout == 0
        )

        def look_on() -> bool:
            over = training.decisions >= decisions
            with _own_chance():
                if after_decision is not None:
                    after_decision(training)
                if not over and training.decisions % every == 0:
                    report(self.agent())
            return learns_last or not over

        self.model.learn(decisions, callback=_Watch(training, look_on))
        with _own_chance():
            report(self.agent())


class _Watch(BaseCallback):
    """Counts what training takes; `look_on` says after each decision whether to go on."""

    def __init__(self, training: DeepTraining, look_on: Callable[[], bool]) -> None:
        super().__init__()
        self._training = training
        self._look_on = look_on

    def _on_step(self) -> bool:
        training = self._training
        for info, done in zip(self.locals["infos"], self.locals["dones"], strict=True):
            training.decisions += 1
            training.sim_s += float(info["duration"])
            training.virtual_collisions += info["outcome"] == Outcome.VIRTUAL_COLLISION
            training.bumper_contacts += info["bumper_contact"]
            training.episodes += bool(done)
            training.reached += bool(done and not info["TimeLimit.truncated"])
        return self._look_on()


def make_model(
    settings: DeepSettings, env: "gymnasium.Env[Any, Any]", seed: int
) -> SAC | TD3 | PPO:
    """Return Stable-Baselines3's learner of these settings."""
    shared: dict[str, Any] = {
        "policy": "MlpPolicy",
        "env": env,
        "seed": seed,
        "device": "cpu",
        "learning_rate": settings.learning_rate,
        "gamma": settings.gamma,
        "batch_size": settings.batch_size,
        "policy_kwargs": {"net_arch": [*settings.hidden]},
    }
    if isinstance(settings, PpoSettings):
        shared["policy_kwargs"]["log_std_init"] = math.log(settings.spread)
        return PPO(
            **shared,
            n_steps=settings.rollout,
            n_epochs=settings.epochs,
            gae_lambda=settings.gae_lambda,
        )
    shared |= {
        "buffer_size": settings.buffer_size,
        "learning_starts": settings.learning_starts,
        "gradient_steps": settings.gradient_steps,
        "tau": settings.tau,
    }
    if isinstance(settings, Td3Settings):
        noise = NormalActionNoise(np.zeros(2), np.full(2, settings.exploration))
        return TD3(**shared, action_noise=noise)
    return SAC(**shared, ent_coef=f"auto_{settings.entropy}")


def policy_of(model: SAC | TD3 | PPO) -> Policy:
    """Return what ``predict(deterministic=True)`` of a learner calculates, as a copy."""
    if isinstance(model, PPO):
        modules = [*model.policy.mlp_extractor.policy_net, model.policy.action_net]
        hidden, bound = "tanh", "clip"
    elif isinstance(model, TD3):
        modules, hidden, bound = [*model.actor.mu], "relu", "tanh"
    else:
        modules, hidden, bound = [*model.actor.latent_pi, model.actor.mu], "relu", "tanh"
    layers = [module for module in modules if isinstance(module, nn.Linear)]
    weights = tuple(layer.weight.detach().numpy().copy() for layer in layers)
    biases = tuple(layer.bias.detach().numpy().copy() for layer in layers)
    return Policy(weights, biases, hidden, bound)


@contextmanager
def _own_chance() -> Generator[None, None, None]:
    """Put the global generators, which Stable-Baselines3 draws from, back as they were before."""
    before = random.getstate(), np.random.get_state(), torch.get_rng_state()  # noqa: NPY002
    try:
        yield
    finally:
        random.setstate(before[0])
        np.random.set_state(before[1])  # noqa: NPY002
        torch.set_rng_state(before[2])


@contextmanager
def _one_thread() -> Generator[None, None, None]:
    """Let PyTorch calculate in one thread, always the same bits."""
    threads = torch.get_num_threads()
    deterministic = torch.are_deterministic_algorithms_enabled()
    torch.set_num_threads(1)
    torch.use_deterministic_algorithms(True)
    try:
        yield
    finally:
        torch.set_num_threads(threads)
        torch.use_deterministic_algorithms(deterministic)
