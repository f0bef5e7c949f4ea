"""The motor task: its actions, rewards and the ends of its episodes."""

import math
from typing import Any

import numpy as np
import pytest
from dm_control.utils import rewards
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj import MotorConfig, MotorEnvironment, RangeNoise
from nomad_mj.errors import ConfigError
from nomad_mj.scene import build_scene
from nomad_mj.tasks import MotorTask
from nomad_mj.tasks.motor import REWARD_MARGIN

SCENE = build_scene("empty_room", "nomad200")
GOAL = SCENE.arena.goal


def motor(time_limit: float = 60.0, **options: Any) -> MotorEnvironment:
    return MotorEnvironment(MotorTask(SCENE, MotorConfig(**options), 0), time_limit=time_limit)


ENV = motor()


def test_actions_are_the_motors_speeds_within_their_limits() -> None:
    spec = ENV.action_spec()
    np.testing.assert_allclose(spec.maximum, [0.61, math.radians(60), math.radians(90)], atol=1e-4)
    np.testing.assert_array_equal(spec.minimum, -spec.maximum)
    assert spec.name == "translate\tsteer\tturret" and spec.dtype == np.float64
    assert ENV.control_timestep() == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("motor_index", "limit"), [(0, 0.61), (1, math.radians(60)), (2, math.radians(90))]
)
def test_each_motor_comes_to_the_speed_it_is_told(motor_index: int, limit: float) -> None:
    for speed in (limit, -0.5 * limit, 3 * limit):  # beyond the limit it does what it can
        ENV.reset(seed=0, start=(5.0, 5.0))
        action = np.zeros(3)
        action[motor_index] = speed
        readings = [ENV.step(action).observation["encoders"].copy() for _ in range(60)]
        driven = readings[-1][0] / 0.05
        turned = (readings[-1] - readings[-2])[1:] / 0.05
        reached = [driven, *turned][motor_index]
        assert reached == pytest.approx(float(np.clip(speed, -limit, limit)), rel=0.02)


@settings(max_examples=50)
@given(st.floats(0.3, 9.7), st.floats(0.3, 9.7))
def test_the_reward_is_dm_controls_tolerance_of_the_true_distance(x: float, y: float) -> None:
    ENV.reset(start=(x, y))
    distance = math.hypot(*(GOAL - [x, y]))
    assert ENV.task.goal_distance(ENV.physics) == pytest.approx(distance)
    wanted = rewards.tolerance(distance, (0.0, 0.2), margin=REWARD_MARGIN)
    assert ENV.task.get_reward(ENV.physics) == pytest.approx(wanted)
    assert 0 <= ENV.task.get_reward(ENV.physics) <= 1


def test_the_goal_ends_the_episode_with_discount_0() -> None:
    env = motor()
    env.reset(start=(GOAL[0] - 0.5, GOAL[1]))
    steps = [env.step((0.5, 0, 0)) for _ in range(40)]
    last = next(step for step in steps if step.last())
    assert last.discount == 0 and last.reward == 1
    assert math.hypot(*(env.physics.pose()[:2] - GOAL)) > 0  # went on with a new episode
    assert all(step.discount == 1 for step in steps[1 : steps.index(last)])
    assert steps[steps.index(last) + 1].first()


def test_the_goal_does_not_end_the_episode_where_it_should_not() -> None:
    env = motor(ends_at_goal=False)
    env.reset(start=(GOAL[0], GOAL[1]))
    assert not any(env.step((0.0, 0, 0)).last() for _ in range(5))


@pytest.mark.parametrize(("time_limit", "steps"), [(0.5, 10), (0.05, 1), (0.02, 1)])
def test_time_ends_the_episode_with_discount_1(time_limit: float, steps: int) -> None:
    env = motor(time_limit)
    for _ in range(2):
        env.reset()
        made = [env.step((0, 0, 0)) for _ in range(steps)]
        assert [step.last() for step in made] == [False] * (steps - 1) + [True]
        assert made[-1].discount == 1


def test_readings_are_drawn_once_a_step_and_not_shared_between_steps() -> None:
    first = ENV.reset(seed=0, start=4)
    again = ENV.task.get_observation(ENV.physics)
    for name, value in first.observation.items():
        np.testing.assert_array_equal(again[name], value)
    kept = {name: value.copy() for name, value in first.observation.items()}
    second = ENV.step((0.1, 0.1, 0.1))
    for name, value in first.observation.items():
        np.testing.assert_array_equal(value, kept[name])
        assert not np.shares_memory(value, second.observation[name])
    assert (first.observation["sonar"] != second.observation["sonar"]).any()


def test_nothing_observed_is_constant_while_driving_about() -> None:
    ENV.reset(seed=0, start=(0.6, 1.0, 3.0))
    rng = np.random.default_rng(0)
    seen = [ENV.step(rng.uniform(-0.6, 1, 3)).observation for _ in range(60)]
    for name in seen[0]:
        assert np.ptp([step[name] for step in seen], axis=0).any(), name


def test_flat_observations_are_as_long_as_their_specification() -> None:
    env = MotorEnvironment(MotorTask(SCENE), flat_observation=True)
    (spec,) = env.observation_spec().values()
    for step in (env.reset(), env.step((0, 0, 0))):
        (value,) = step.observation.values()
        spec.validate(value)
    parts = ENV.observation_spec().values()
    assert spec.shape == (sum(int(np.prod(part.shape)) for part in parts),)


def test_a_noise_of_its_own_is_used() -> None:
    env = motor(range_noise=RangeNoise("none"))
    readings = [env.reset(start=(5.0, 5.0)).observation["sonar"] for _ in range(2)]
    np.testing.assert_array_equal(*readings)


@pytest.mark.parametrize("radius", [0.0, -1.0, math.nan])
def test_a_goal_radius_that_makes_no_sense_is_refused(radius: float) -> None:
    with pytest.raises(ConfigError, match=r"^goal radius .*: must be above 0 m$"):
        MotorConfig(goal_radius=radius)


@pytest.mark.parametrize("time_limit", [0.0, -1.0, math.nan])
def test_a_time_limit_that_makes_no_sense_is_refused(time_limit: float) -> None:
    with pytest.raises(ConfigError, match=r"^time limit .*: must be above 0 s$"):
        motor(time_limit)
