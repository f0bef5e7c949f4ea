"""Deep learners learn in a small room: reproducibly, observed or not, and leave no trace."""

import random
from collections.abc import Generator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import gymnasium
import numpy as np
import pytest
from nomad_agents.deep import LEARNERS, DeepAgent, DeepSettings, PpoSettings
from nomad_agents.deep.environment import make_env
from nomad_agents.deep.training import DeepTraining, train_deep
from nomad_agents.episode import run_episode

import nomad_mj
from nomad_mj.errors import ConfigError, OutputError

torch = pytest.importorskip("torch")
pytest.importorskip("stable_baselines3")
DECISIONS = 150
ROBOT = "omnibot"  # the one that is simulated fastest


def small(name: str) -> DeepSettings:
    """Return settings of an algorithm that learns a little in no time."""
    settings = replace(LEARNERS[name](), hidden=(32, 32), batch_size=32, episode_decisions=20)
    if isinstance(settings, PpoSettings):
        return replace(settings, rollout=32)
    return replace(settings, learning_starts=30)


@pytest.fixture
def learning_env(small_room: Path) -> Generator["gymnasium.Env[Any, Any]", None, None]:
    with closing(make_env(small("sac"), "ranges", small_room, ROBOT)) as env:
        yield env


def bits(agent: DeepAgent) -> dict[str, bytes]:
    return {name: array.tobytes() for name, array in agent.policy.arrays().items()}


@pytest.mark.parametrize(
    ("name", "observation"), [("sac", "situation"), ("td3", "ranges"), ("ppo", "situation")]
)
def test_each_learns_and_then_drives(small_room: Path, name: str, observation: str) -> None:
    seen: list[tuple[DeepAgent, int, float]] = []

    def look(agent: DeepAgent, decisions: int, sim_s: float) -> None:
        seen.append((agent, decisions, sim_s))

    training = DeepTraining()
    with closing(make_env(small(name), observation, small_room, ROBOT)) as learning:
        agent = train_deep(small(name), learning, 3, DECISIONS, 50, look, training=training)
    assert [decisions for _, decisions, _ in seen] == [50, 100, 150]
    assert training.decisions == DECISIONS and training.sim_s == seen[-1][2] > seen[0][2] > 20
    assert training.reached <= training.episodes >= DECISIONS // 20
    assert training.virtual_collisions > 0
    assert agent.name == name and agent.observation == observation
    assert bits(agent) == bits(seen[-1][0]) != bits(seen[0][0]), "it changes while it learns"
    with nomad_mj.load("path_finding", small_room, ROBOT) as env:
        episode = run_episode(env, agent, seed=1, start=0, max_decisions=5)
    assert episode.decisions > 0 and episode.reactions == episode.decisions


def test_the_same_seed_gives_the_same_bits_however_it_is_watched(
    learning_env: "gymnasium.Env[Any, Any]",
) -> None:
    def disturb(agent: DeepAgent, decisions: int, sim_s: float) -> None:
        random.random()
        np.random.rand()  # noqa: NPY002
        torch.rand(3)

    settings = small("sac")
    alone = train_deep(settings, learning_env, 3, 80)
    watched = train_deep(settings, learning_env, 3, 80, 20, disturb)
    other = train_deep(settings, learning_env, 4, 80)
    assert bits(alone) == bits(watched) != bits(other)


def test_what_is_global_is_left_as_it_was(learning_env: "gymnasium.Env[Any, Any]") -> None:
    def state() -> tuple[Any, ...]:
        numbers = cast(Any, np.random.get_state())  # noqa: NPY002
        drawn = random.getstate(), numbers[1].tobytes(), torch.get_rng_state().numpy().tobytes()
        return *drawn, torch.get_num_threads(), torch.are_deterministic_algorithms_enabled()

    def interrupt(training: DeepTraining) -> None:
        assert torch.get_num_threads() == 1
        if training.decisions == 5:
            raise KeyboardInterrupt

    before = state()
    with pytest.raises(KeyboardInterrupt):
        train_deep(small("sac"), learning_env, 3, 20, after_decision=interrupt)
    assert state() == before


def test_curves_for_tensorboard(small_room: Path, tmp_path: Path) -> None:
    pytest.importorskip("tensorboard")
    settings = replace(small("ppo"), rollout=10, batch_size=5, episode_decisions=5)
    with closing(make_env(settings, "ranges", small_room, ROBOT)) as learning:
        for seed in (2, 3):  # the curves of the first training give way to those of the second
            train_deep(settings, learning, seed, 21, log_folder=tmp_path / "curves")
        (tmp_path / "file").touch()
        with pytest.raises(OutputError, match=r"cannot write curves to .*file/x': Not a dir"):
            train_deep(settings, learning, 3, 21, log_folder=tmp_path / "file" / "x")
    (curves,) = (tmp_path / "curves").iterdir()
    assert curves.name.startswith("events.out.tfevents")
    assert b"rollout/ep_rew_mean" in curves.read_bytes()


def test_a_foreign_environment_is_refused() -> None:
    foreign = gymnasium.make("Pendulum-v1")
    with pytest.raises(ConfigError, match=r"Pendulum-v1: deep learners .* 'nomad_mj/PathFinding"):
        train_deep(small("sac"), foreign, 0, 10)
    with pytest.raises(ConfigError, match=r"observation 'dict': must be one of: situation, ranges"):
        make_env(small("sac"), "dict")


def test_ppo_learns_from_every_whole_rollout(small_room: Path) -> None:
    settings, made = small("ppo"), list[DeepAgent]()

    def look(agent: DeepAgent, decisions: int, sim_s: float) -> None:
        made.append(agent)

    with closing(make_env(settings, "ranges", small_room, ROBOT)) as learning:
        agents = [train_deep(settings, learning, 3, decisions) for decisions in (32, 63, 64)]
        train_deep(settings, learning, 3, 64, 32, look)
        with pytest.raises(ConfigError, match="decisions 31: PPO learns nothing from fewer"):
            train_deep(settings, learning, 3, 31)
    once, still_once, twice = map(bits, agents)
    assert once == still_once != twice == bits(made[-1])
    assert bits(made[0]) != once, "seen in the middle, before it learns from the rollout"
    assert len(made) == 2


@pytest.mark.parametrize(("decisions", "every", "seed"), [(0, 0, 0), (5, -1, 0), (5, 0, -1)])
def test_wrong_numbers_are_refused(decisions: int, every: int, seed: int) -> None:
    with pytest.raises(ConfigError, match=r"(decisions 0|every -1|seed -1): must be [01] or more$"):
        train_deep(small("sac"), cast(Any, None), seed, decisions, every)
