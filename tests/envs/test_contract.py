"""dm_env's own contract test over every task, in every room, with either robot."""

import unittest
from collections.abc import Iterator
from functools import cache
from itertools import product
from typing import Any

import numpy as np
from dm_env import Environment, test_utils

from nomad_mj.assets import list_robots, list_rooms
from nomad_mj.envs import TASKS, PathFinding
from nomad_mj.scene import Scene, build_scene
from nomad_mj.tasks import MotorConfig, MotorEnvironment, MotorTask

# The wheels differ in their physics, not in their interface: one room will do for them.
CASES = [*product(TASKS, list_rooms(), ["nomad200"]), *product(TASKS, ["corridor"], list_robots())]
scene = cache(build_scene)


def make(task: str, built: Scene, seed: int = 0) -> Environment:
    """Return an environment with episodes short enough to see their end."""
    if task == "motor":
        return MotorEnvironment(MotorTask(built, random=seed), time_limit=0.5)
    motor = MotorTask(built, MotorConfig(ends_at_goal=False), seed)
    return PathFinding(MotorEnvironment(motor, time_limit=np.inf), time_limit=6.0)


class Contract(test_utils.EnvironmentTestMixin):
    """What the cases below share; not collected, since it is no TestCase."""

    case: tuple[str, str, str]
    environment: Environment

    def make_object_under_test(self) -> Environment:
        task, room, robot = self.case
        return make(task, scene(room, robot))

    def make_action_sequence(self) -> Iterator[Any]:
        spec: Any = self.environment.action_spec()
        rng = np.random.default_rng(0)
        for _ in range(25 if self.case[0] == "motor" else 5):
            yield rng.uniform(spec.minimum, spec.maximum, spec.shape)

    def test_rewards_and_discounts_are_floats_within_their_specifications(self) -> None:
        env: Environment = self.environment
        env.reset()
        step = env.step(self.make_action())
        assert isinstance(step.reward, float) and isinstance(step.discount, float)
        env.reward_spec().validate(step.reward)


for case in dict.fromkeys(CASES):
    name = "Test" + "".join(part.title().replace("_", "") for part in case)
    globals()[name] = type(name, (Contract, unittest.TestCase), {"case": case})
