"""Both checkers, Gymnasium's own and that of Stable-Baselines3, find nothing to complain of."""

import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import nomad_mj.gym
from nomad_mj.assets import list_robots
from nomad_mj.gym.registration import MOTOR, PATH_FINDING

CASES = [
    *((PATH_FINDING, "corridor", robot, "ranges") for robot in list_robots()),
    *((MOTOR, "corridor", robot, "dict") for robot in list_robots()),
    (PATH_FINDING, "paper_room", "nomad200", "situation"),
    (PATH_FINDING, "moving_room", "khepera", "dict"),
    (PATH_FINDING, "empty_room", "racer", "dict"),
    (MOTOR, "moving_room", "racer", "ranges"),
    (MOTOR, "empty_room", "khepera", "ranges"),
]


@pytest.mark.parametrize(("name", "room", "robot", "observation"), CASES)
def test_the_checker_finds_nothing(name: str, room: str, robot: str, observation: str) -> None:
    env = gymnasium.make(name, room=room, robot=robot, observation=observation)
    thorough = robot == "khepera"
    check_env(env.unwrapped, skip_render_check=True, skip_close_check=not thorough)
    env.action_space.seed(0)
    observed, info = env.reset(seed=1)
    keys = set(info)
    for _ in range(10):
        assert observed in env.observation_space
        observed, _, terminated, truncated, info = env.step(env.action_space.sample())
        assert set(info) == keys
        if terminated or truncated:
            env.reset()
    env.close()
    env.close()


@pytest.mark.parametrize("name", [PATH_FINDING, MOTOR])
@pytest.mark.parametrize("observation", ["ranges", "dict"])
def test_stable_baselines3_takes_it_as_it_is(name: str, observation: str) -> None:
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    env = gymnasium.make(name, robot="khepera", observation=observation)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        checker.check_env(env.unwrapped)
    env.close()


@pytest.mark.gl
@pytest.mark.parametrize(("name", "fps"), [(PATH_FINDING, 2), (MOTOR, 20)])
def test_the_checker_draws(name: str, fps: int) -> None:
    env = gymnasium.make(name, robot="khepera", render_mode="rgb_array", width=96, height=64)
    check_env(env.unwrapped, skip_close_check=True)
    assert env.metadata["render_fps"] == fps
    env.close()


def test_ids_are_registered_once_and_by_the_entry_point() -> None:
    from importlib.metadata import entry_points

    before = gymnasium.registry[PATH_FINDING]
    (found,) = [e for e in entry_points(group="gymnasium.envs") if e.name == "nomad_mj"]
    register: Any = found.load()
    register()
    assert register is nomad_mj.gym.register
    assert gymnasium.registry[PATH_FINDING] is before


def test_a_policy_that_goes_straight_is_told_of_success_and_of_cost() -> None:
    env = gymnasium.make(PATH_FINDING, room="empty_room", goal_bonus=2.0)
    env.reset(seed=0, options={"start": 0})
    terminated, rewards = False, list[float]()
    info: dict[str, Any] = {}
    while not terminated:
        _, reward, terminated, truncated, info = env.step(np.array([1, 0], dtype=np.float32))
        rewards.append(float(reward))
        assert not truncated
    assert info["is_success"] and info["total_cost"] == 0.0
    assert info["goal_distance"] <= 0.2
    assert rewards == [0.0] * (len(rewards) - 1) + [2.0]
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(np.array([1, 0], dtype=np.float32))
    env.close()


def test_what_stops_the_robot_costs() -> None:
    env = gymnasium.make(PATH_FINDING, room="paper_room", robot="khepera", time_limit=60.0)
    env.reset(seed=0, options={"start": (5.0, 2.0)})
    costs = list[float]()
    truncated, info = False, dict[str, Any]()
    while not truncated:
        _, reward, _, truncated, info = env.step(np.array([1, 0], dtype=np.float32))
        assert info["cost"] == info["virtual_collision"] + info["bumper_contact"]
        assert (float(reward) <= -0.5) == info["virtual_collision"]
        costs.append(info["cost"])
    assert sum(costs) == info["total_cost"] > 0
    assert info["total_duration"] >= 60.0 and not info["is_success"]
    env.close()
