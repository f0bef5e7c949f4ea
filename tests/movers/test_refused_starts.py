"""Where what moves finds no place beside the robot, and how one goes on after that."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded

import nomad_mj.gym
from nomad_mj import MovingObstacles, load, load_batch
from nomad_mj.errors import StartError

LARGE: dict[str, Any] = {"moving_obstacles": MovingObstacles(count=1, radius=1.2)}
BLOCKED = 24  # a start of the corridor at which so large an obstacle finds no place


def test_of_its_own_choice_the_robot_starts_where_there_is_room() -> None:
    with load(room="corridor", task_kwargs=LARGE | {"random": 0}) as env:
        starts = {env.reset() and env.motor.task.start_pose[:2] for _ in range(20)}
        assert len(starts) > 3
        with pytest.raises(StartError, match="no place found for moving obstacle"):
            env.reset(start=BLOCKED)


@pytest.mark.parametrize("task", ["motor", "path_finding"])
def test_after_a_refused_start_the_next_step_begins_another_episode(task: Any) -> None:
    env = load(task, "corridor", task_kwargs=LARGE | {"random": 0})
    env.reset()
    with pytest.raises(StartError):
        env.reset(start=BLOCKED)
    assert env.step(np.zeros(env.action_spec().shape)).first()
    assert env.step(np.zeros(env.action_spec().shape)).mid()
    env.close()


def test_a_gymnasium_environment_asks_for_a_reset() -> None:
    assert nomad_mj.gym
    env = gymnasium.make("nomad_mj/Motor-v0", room="corridor", task_kwargs=LARGE)
    env.reset(seed=0)
    with pytest.raises(StartError):
        env.reset(options={"start": BLOCKED})
    with pytest.raises(ResetNeeded):
        env.unwrapped.step(np.zeros(3))
    env.reset()
    env.close()


def test_in_a_batch_the_world_is_named_and_all_begin_anew() -> None:
    with load_batch("motor", 2, "corridor", task_kwargs=LARGE | {"random": 0}) as many:
        many.reset()
        with pytest.raises(StartError, match="world 1: no place found for moving obstacle"):
            many.reset(seed=[0, 1], starts=[None, BLOCKED])
        assert many.step(np.zeros((2, 3))).first().all()
        assert many.step(np.zeros((2, 3))).mid().all()
