"""A copy of an environment is an environment of its own: what it tells is its own robot's."""

import copy
import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ClosedEnvironmentError

from nomad_mj import MovingObstacles, Walkers
from nomad_mj.gym.base import NavigationEnv
from nomad_mj.gym.registration import MOTOR, PATH_FINDING


def copied(env: NavigationEnv, how: str) -> NavigationEnv:
    return copy.deepcopy(env) if how == "deepcopy" else pickle.loads(pickle.dumps(env))


def made(name: str, **options: Any) -> NavigationEnv:
    env = gymnasium.make(name, robot="khepera", **options).unwrapped
    assert isinstance(env, NavigationEnv)
    return env


@pytest.mark.parametrize("how", ["deepcopy", "pickle"])
@pytest.mark.parametrize("name", [MOTOR, PATH_FINDING])
def test_a_copy_counts_its_own_costs_and_outlives_the_original(name: str, how: str) -> None:
    env = made(name, room="paper_room")
    env.reset(seed=0)
    twin = copied(env, how)
    action = np.ones(env.action_space.shape or ())
    told: list[list[Any]] = []
    for each in (env, twin):  # one after the other: neither looks at the other's robot
        infos = [each.step(action) for _ in range(40 if name == MOTOR else 4)]
        told.append([(step[1], step[4]["driven"], step[4]["total_cost"]) for step in infos])
    assert told[0] == told[1]
    assert sum(driven for _, driven, _ in told[1]) > 0.05
    env.close()
    twin.step(action)
    twin.close()


@pytest.mark.gl
@pytest.mark.parametrize("how", ["deepcopy", "pickle"])
def test_a_copy_draws_its_own_way(how: str) -> None:
    env = made(PATH_FINDING, render_mode="rgb_array", view="top", width=96, height=96)
    env.reset(seed=0)
    env.step(np.array([1.0, 0.3]))
    env.render()
    twin = copied(env, how)
    env.close()
    before = twin.render()
    twin.step(np.array([1.0, 0.3]))
    after = twin.render()
    assert before is not None and after is not None and (before != after).any()
    twin.close()


def test_after_close_every_call_says_so() -> None:
    env = made(MOTOR)
    env.reset(seed=0)
    env.close()
    for call in (env.reset, lambda: env.step(np.zeros(2))):
        with pytest.raises(ClosedEnvironmentError, match="has been closed"):
            call()


@pytest.mark.parametrize("movers", [Walkers(count=2), MovingObstacles(count=1)])
def test_a_saved_specification_makes_the_same_movers(movers: MovingObstacles) -> None:
    env = gymnasium.make(PATH_FINDING, task_kwargs={"moving_obstacles": movers})
    spec = env.spec
    assert spec is not None
    again = gymnasium.make(type(spec).from_json(spec.to_json()))
    for one, other in zip(env.reset(seed=3)[0], again.reset(seed=3)[0], strict=True):
        assert one == other
    moving = again.unwrapped.environment.scene.moving  # type: ignore[attr-defined]
    assert len(moving.obstacles) == movers.count
    assert bool(moving.obstacles[0].walker) == isinstance(movers, Walkers)
    env.close()
    again.close()
