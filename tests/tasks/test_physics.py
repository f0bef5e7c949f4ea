"""dm_control's Physics, as dm_control's users know it: copies, pickles, errors, freeing."""

import gc
import pickle
import weakref

import numpy as np
import pytest
from dm_control.rl.control import PhysicsError

from nomad_mj import MotorEnvironment, load
from nomad_mj.tasks import NavigationPhysics

ROBOTS = ("nomad200", "nomad200_wheels")


def started(robot: str = "nomad200") -> MotorEnvironment:
    env = load("motor", robot=robot, task_kwargs={"random": 0})
    env.reset(start=(5.0, 3.0, 1.0))
    for _ in range(5):
        env.step((0.3, 0.2, 0.4))
    return env


def senses(physics: NavigationPhysics) -> list[float]:
    parts = (np.array(physics.pose()), physics.cone_ranges(), physics.encoders(), physics.bumpers())
    return np.concatenate(parts).tolist()


def drive(physics: NavigationPhysics) -> list[list[float]]:
    told: list[list[float]] = []
    for tick in range(30):
        physics.data.ctrl[:3] = 0.6, 0.1 * tick, -0.5
        physics.step(10)
        told.append(senses(physics))
    return told


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("way", ["copy", "shared model", "pickle"])
def test_a_copy_goes_on_from_the_same_state_to_the_same_bits(robot: str, way: str) -> None:
    env = started(robot)
    if way == "pickle":
        other: NavigationPhysics = pickle.loads(pickle.dumps(env.physics))
    else:
        other = env.physics.copy(share_model=way == "shared model")
    assert isinstance(other, NavigationPhysics)
    assert senses(other) == senses(env.physics)
    here = drive(env.physics)
    assert senses(other) != here[-1]  # and is independent of it
    assert drive(other) == here
    other.free()
    env.close()


def test_step_by_step_is_the_same_as_many_at_once() -> None:
    env = started()
    other = env.physics.copy()
    for physics, parts in ((env.physics, [10]), (other, [1] * 10)):
        for _ in range(20):
            physics.data.ctrl[:3] = 0.4, 0.3, -0.2
            for part in parts:
                physics.step(part)
    np.testing.assert_array_equal(env.physics.data.qpos, other.data.qpos)
    np.testing.assert_array_equal(env.physics.cone_ranges(), other.cone_ranges())
    env.close()


@pytest.mark.parametrize("what", ["position", "velocity"])
def test_a_simulation_that_diverges_says_so_and_can_be_reset(what: str) -> None:
    env = started()
    if what == "position":
        env.physics.data.qpos[0] = np.nan
    else:
        env.physics.data.qvel[0] = 1e12
    with pytest.raises(PhysicsError, match=r"^the simulation diverged at 0\.\d+ s: mjWARN_BAD"):
        env.step(np.zeros(3))
    assert env.step(np.zeros(3)).first()
    before = env.reset(seed=0, start=0).observation
    assert np.isfinite(env.step((0.1, 0, 0)).observation["odometry"]).all()
    fresh = load("motor").reset(seed=0, start=0).observation
    for name, value in before.items():
        np.testing.assert_array_equal(value, fresh[name])
    env.close()


def test_closing_lets_the_simulation_go_and_may_be_done_twice() -> None:
    env = started()
    try:
        data = weakref.ref(env.physics.data.ptr)
    except TypeError:
        pytest.skip("this mujoco's MjData cannot be referred to weakly")
    env.close()
    gc.collect()
    assert data() is None
    env.close()


def test_named_indexing_knows_the_robot_and_the_room() -> None:
    env = started()
    named = env.physics.named
    x, y, heading = env.physics.pose()
    assert named.data.qpos[["robot/base_x", "robot/base_y"]].tolist() == [x, y]
    assert named.data.qpos["robot/steer"][0] == heading
    assert named.data.site_xpos["room/goal"][:2] == pytest.approx(env.task.scene.arena.goal)
    env.close()
