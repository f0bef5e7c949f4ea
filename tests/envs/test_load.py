"""Loading by name, with the options that there are and no others."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nomad_mj import MotorEnvironment, NomadError, OdometryNoise, PathFinding, RangeNoise, load
from nomad_mj.errors import ConfigError, UnknownNameError
from nomad_mj.motion import MotionConfig


def test_path_finding_in_the_papers_room_is_what_one_gets_by_default() -> None:
    env = load()
    assert isinstance(env, PathFinding)
    assert env.scene.arena.name == "paper_room" and env.scene.robot.name == "nomad200"
    assert env.motor.task.config.range_noise == RangeNoise("uniform", 0.15)
    assert env.motor.task.config.odometry_noise == OdometryNoise(0, 0, 0)
    env.close()


def test_options_reach_the_task_and_the_environment() -> None:
    noise, motion = RangeNoise("gaussian", 0.1), MotionConfig(retract=0.2)
    options: dict[str, Any] = {
        "range_noise": noise,
        "goal_radius": 0.3,
        "rays_per_cone": 3,
        "random": 4,
    }
    motor = load("motor", task_kwargs=options, environment_kwargs={"flat_observation": True})
    assert isinstance(motor, MotorEnvironment)
    assert motor.task.config.range_noise == noise and motor.task.config.goal_radius == 0.3
    assert len(motor.task.scene.robot.rays.address) == 96
    assert list(motor.reset().observation) == ["observations"]
    motor.close()
    options["motion"] = motion
    env = load(task_kwargs=options, environment_kwargs={"time_limit": 1.0})
    assert env.config.motion == motion and env.motor.task.config.range_noise == noise
    assert not env.motor.task.config.ends_at_goal
    env.close()


def test_a_room_and_a_robot_of_ones_own_are_taken_as_readily_as_a_name(
    ring_robot: Callable[..., Path], own_room: Callable[..., Path]
) -> None:
    for as_type in (str, Path):
        env = load(room=as_type(own_room()), robot=as_type(ring_robot()))
        step = env.reset(start=(-3.0, -3.0))
        assert step.observation["infrared"].shape == (8,)
        for _ in range(10):
            step = env.step((1, 0))
            if step.last():
                break
        assert step.discount == 0
        env.close()


REFUSED: list[tuple[dict[str, Any], type[NomadError], str]] = [
    (
        {"task_name": "swim"},
        UnknownNameError,
        "unknown task 'swim'; there are: motor, path_finding",
    ),
    (
        {"task_kwargs": {"speed": 1}},
        ConfigError,
        "unknown task option 'speed'; there are: random, ",
    ),
    ({"task_kwargs": {"ends_at_goal": True}}, ConfigError, "unknown task option 'ends_at_goal'"),
    ({"task_name": "motor", "task_kwargs": {"motion": 1}}, ConfigError, "task option 'motion'"),
    (
        {"environment_kwargs": {"fast": 1}},
        ConfigError,
        "environment option 'fast'; there are: time",
    ),
    ({"environment_kwargs": {"flat_observation": True}}, ConfigError, "'flat_observation'"),
    ({"environment_kwargs": {"time_limit": 0}}, ConfigError, "time limit 0: must be above 0 s"),
    ({"environment_kwargs": {"time_limit": np.nan}}, ConfigError, "time limit nan: must be above"),
    ({"task_kwargs": {"random": -1}}, ConfigError, "seed -1: must be a whole number from 0 on"),
    ({"task_kwargs": {"rays_per_cone": 1}}, ConfigError, "rays per cone: 1 is not in 2 to 64"),
    ({"task_kwargs": {"goal_radius": 0}}, ConfigError, "goal radius 0: must be above 0 m"),
    (
        {"task_kwargs": {"goal_radius": "x"}},
        ConfigError,
        "task option 'goal_radius': must be a number, not 'x'",
    ),
    ({"task_kwargs": {"goal_radius": True}}, ConfigError, "must be a number, not True"),
    ({"task_kwargs": {"range_noise": 0.3}}, ConfigError, "must be a RangeNoise, not 0.3"),
    ({"task_kwargs": {"odometry_noise": None}}, ConfigError, "be an OdometryNoise, not None"),
    ({"task_kwargs": {"action": (1, 2)}}, ConfigError, "'action': must be an ActionSpec, not (1,"),
    ({"task_kwargs": {"motion": "x" * 99}}, ConfigError, "must be a MotionConfig, not 'xxx"),
    ({"task_kwargs": {"rays_per_cone": 2.5}}, ConfigError, "a whole number or None, not 2.5"),
    ({"task_kwargs": {"range_noise": np.eye(9)}}, ConfigError, "not array([[1., 0., 0."),
    (
        {"task_name": "motor", "task_kwargs": {"ends_at_goal": 1}},
        ConfigError,
        "task option 'ends_at_goal': must be True or False, not 1",
    ),
    (
        {"environment_kwargs": {"time_limit": "1 s"}},
        ConfigError,
        "environment option 'time_limit': must be a number, not '1 s'",
    ),
    (
        {"task_name": "motor", "environment_kwargs": {"flat_observation": "no"}},
        ConfigError,
        "environment option 'flat_observation': must be True or False, not 'no'",
    ),
    ({"room": "nowhere"}, UnknownNameError, "unknown room 'nowhere'; there are: clutter, "),
    ({"robot": "r2d2"}, UnknownNameError, "unknown robot 'r2d2'; there are: khepera, "),
]


@pytest.mark.parametrize(("arguments", "error", "message"), REFUSED)
def test_what_cannot_be_is_refused_in_one_line(
    arguments: dict[str, Any], error: type[NomadError], message: str
) -> None:
    with pytest.raises(error) as caught:
        load(**arguments)
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_numbers_of_numpy_will_do_for_pythons() -> None:
    options: dict[str, Any] = {
        "goal_radius": np.float32(0.25),
        "ends_at_goal": np.bool_(False),
        "rays_per_cone": np.int64(3),
    }
    env = load("motor", task_kwargs=options, environment_kwargs={"time_limit": 1})
    assert env.task.config.goal_radius == 0.25 and not env.task.config.ends_at_goal
    assert len(env.task.scene.robot.rays.address) == 96
    env.close()


def test_mappings_of_options_are_left_as_they_were() -> None:
    task, environment = {"random": 1, "rays_per_cone": 2}, {"time_limit": 5.0}
    load(task_kwargs=task, environment_kwargs=environment).close()
    assert task == {"random": 1, "rays_per_cone": 2} and environment == {"time_limit": 5.0}


@pytest.mark.parametrize(
    ("option", "value"),
    [("ahead", 4.0), ("retract", -1.0), ("braking", 0.0), ("time_out", 0.0), ("creep", np.nan)],
)
def test_moves_that_make_no_sense_are_refused(option: str, value: float) -> None:
    with pytest.raises(ConfigError, match=rf"^{option} .*: must be from "):
        MotionConfig(**{option: value})
