"""Environments in which goals and obstacles move, and what is seen of them."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from nomad_mj import MotorEnvironment, MovingGoal, MovingObstacles, PathFinding, load
from nomad_mj.movers import Movers
from nomad_mj.types import FloatArray

RADIUS = 0.265

FAST: dict[str, Any] = {
    "moving_goal": MovingGoal(speed=1.0),
    "moving_obstacles": MovingObstacles(speed=1.0),
}


def motor(room: str = "paper_room", goal: Any = None, **options: Any) -> MotorEnvironment:
    options = {"random": 0, "ends_at_goal": False} | options
    return load("motor", room=room, task_kwargs=options, goal=goal)


def movers_of(env: MotorEnvironment) -> Movers:
    assert env.task.movers is not None
    return env.task.movers


def drawn_goal(env: MotorEnvironment | PathFinding) -> FloatArray:
    return env.physics.named.data.site_xpos["room/goal"][:2]


def drawn_obstacles(env: MotorEnvironment) -> FloatArray:
    named = env.physics.named.data.xpos
    return np.array([named[f"room/{body.name}"][:2] for body in env.task.scene.moving.obstacles])


def about(env: MotorEnvironment, steps: int, seed: int = 0) -> Iterator[Any]:
    """Drive about at random and yield each time step."""
    rng = np.random.default_rng(seed)
    action = np.zeros(3)
    for tick in range(steps):
        if tick % 20 == 0:
            action = rng.uniform([-0.3, -1, -1], [0.6, 1, 1])
        yield env.step(action)
