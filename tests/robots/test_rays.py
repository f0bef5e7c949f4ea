"""How finely a cone is sampled changes how fine its reading is, and nothing else."""

import math
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest

from nomad_mj.errors import ConfigError
from nomad_mj.scene import CONTROL_TIMESTEP, Scene, build_scene
from nomad_mj.tasks import NavigationPhysics
from nomad_mj.types import FloatArray, Pose

ROBOTS = ("nomad200", "nomad200_wheels")


def ranges(scene: Scene, pose: Pose) -> FloatArray:
    physics = NavigationPhysics.from_scene(scene)
    with physics.reset_context():
        physics.place(pose)
    result = physics.cone_ranges()
    physics.free()
    return result


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("rays", [2, 3, 7, 15])
def test_a_cone_has_as_many_rays_as_asked_over_the_same_opening(robot: str, rays: int) -> None:
    plain = build_scene("empty_room", robot).robot
    fine = build_scene("empty_room", robot, rays_per_cone=rays).robot
    assert len(fine.rays.address) == 32 * rays
    assert np.diff(fine.rays.first).tolist() == [rays] * 31
    for one, other in zip(plain.layout.rings, fine.layout.rings, strict=True):
        assert other.half_angle == pytest.approx(one.half_angle)
        assert other.name == one.name and other.max_range == one.max_range
        np.testing.assert_allclose(
            np.exp(1j * np.array(other.bearings)), np.exp(1j * np.array(one.bearings)), atol=1e-9
        )


def test_more_rays_among_the_old_ones_only_ever_see_nearer_things() -> None:
    pose = Pose(4.1, 3.3, 0.0)
    coarse, fine = (
        ranges(build_scene("clutter", "nomad200", rays_per_cone=n), pose) for n in (3, 9)
    )
    assert (fine <= coarse + 1e-9).all()
    assert (fine < coarse - 1e-3).any()


@pytest.mark.parametrize("rays", [None, 3, 8])
def test_rays_are_cast_once_a_control_step(rays: int | None) -> None:
    scene = build_scene("paper_room", "nomad200", rays_per_cone=rays)
    data = mujoco.MjData(scene.model)
    data.qpos[:2] = 5, 2
    mujoco.mj_forward(scene.model, data)
    data.ctrl[0] = 0.5
    address, changes, before = scene.robot.rays.address, list[int](), np.zeros(1)
    for step in range(100):
        mujoco.mj_step(scene.model, data)
        now = data.sensordata[address]
        if not np.array_equal(now, before):
            changes.append(step)
        before = now
    period = round(CONTROL_TIMESTEP / scene.model.opt.timestep)
    assert set(np.diff(changes[2:])) == {period}


def test_single_rays_stay_single(ring_robot: Callable[..., Path]) -> None:
    scene = build_scene("empty_room", ring_robot(), rays_per_cone=7)
    assert len(scene.robot.rays.address) == 8
    assert scene.robot.layout.rings[0].half_angle == pytest.approx(math.pi / 8)


@pytest.mark.parametrize("rays", [1, 0, -3, 65])
def test_too_few_or_too_many_rays_are_refused(rays: int) -> None:
    with pytest.raises(ConfigError, match=rf"^rays per cone: {rays} is not in 2 to 64$"):
        build_scene("empty_room", "nomad200", rays_per_cone=rays)
