"""A goal that moves or is elsewhere: told, drawn and reached as it is at that instant."""

import math
from itertools import chain
from typing import Any

import mujoco
import numpy as np
from known_movers import about, drawn_goal, drawn_obstacles, motor, movers_of

from nomad_mj import MotorEnvironment, MovingGoal, load


def test_the_goal_told_and_drawn_and_the_one_that_counts_are_one(env: MotorEnvironment) -> None:
    first = env.reset(seed=1, start=0)
    moved = 0.0
    for step in chain([first], about(env, 150)):
        told = step.observation
        goal = env.task.goal
        np.testing.assert_allclose(told["goal"] + told["odometry"][:2], goal, atol=1e-12)
        np.testing.assert_allclose(drawn_goal(env), goal, atol=1e-12)
        pose = env.physics.pose()
        assert env.task.goal_distance(env.physics) == math.dist(pose[:2], goal)
        np.testing.assert_allclose(drawn_obstacles(env), movers_of(env).obstacles, atol=1e-12)
        moved = max(moved, math.dist(goal, env.task.scene.arena.goal))
    assert moved > 1


def test_a_goal_that_comes_to_the_robot_ends_the_episode_of_the_motor_task() -> None:
    env = motor(moving_goal=MovingGoal(speed=1.0, spread=0.0), ends_at_goal=True)
    x, y = env.task.scene.arena.goal
    step = env.reset(start=(x - 1.5, y))
    for _ in range(300):
        step = env.step(np.zeros(3))
        assert step.last() == (math.dist(env.task.goal, (x - 1.5, y)) <= 0.2)
        if step.last():
            break
    assert step.last() and step.discount == 0 and step.reward == 1
    env.close()


def test_a_move_of_path_finding_ends_at_the_goal_as_it_then_is() -> None:
    env = load(room="empty_room", task_kwargs={"random": 0, "moving_goal": MovingGoal()})
    ends = 0
    for start in range(4):
        step = env.reset(start=start)
        for _ in range(25):
            step = env.step((1.0, 0.0))
            told, pose = step.observation, env.physics.pose()
            goal = told["goal"] + told["odometry"][:2]
            np.testing.assert_allclose(goal, env.motor.task.goal, atol=1e-9)
            np.testing.assert_allclose(drawn_goal(env), env.motor.task.goal, atol=1e-12)
            near = math.dist(pose[:2], env.motor.task.goal) <= 0.2
            assert near == (step.last() and step.discount == 0)
            if step.last():
                ends += near
                break
    assert ends
    env.close()


def test_another_goal_is_told_and_drawn_and_starts_are_checked_against_it() -> None:
    both: list[dict[str, Any]] = [{}, {"moving_goal": MovingGoal()}]
    for options in both:
        env = motor(goal=(2.4, 4.2), **options)
        step = env.reset(start=0)
        np.testing.assert_allclose(env.task.scene.arena.goal, (2.4, 4.2))
        np.testing.assert_allclose(
            step.observation["goal"], np.array([2.4, 4.2]) - [5, 10 / 3], atol=1e-3
        )
        np.testing.assert_allclose(drawn_goal(env), (2.4, 4.2))
        here, plain = env.task.scene.model, motor().task.scene.model
        for what in ("site_size", "site_rgba", "site_type", "site_matid", "site_group"):
            index = [
                mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_SITE, "room/goal") for m in (here, plain)
            ]
            looks = [getattr(m, what)[i] for m, i in zip((here, plain), index, strict=True)]
            np.testing.assert_array_equal(*looks)
        env.close()
