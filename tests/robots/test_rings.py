"""Range sensors are found by name and type, whatever their number and bearings."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj.errors import ModelError
from nomad_mj.robots import RobotDescription, group_rays
from nomad_mj.scene import build_scene
from nomad_mj.types import RangeRing

RingRobot = Callable[..., Path]


def described(robot: Path | str, rays: int | None = None) -> RobotDescription:
    return build_scene("empty_room", robot, rays_per_cone=rays).robot


def only_ring(robot: Path) -> RangeRing:
    (ring,) = described(robot).layout.rings
    return ring


@given(st.randoms(use_true_random=False), st.integers(1, 6), st.integers(1, 12))
def test_rays_are_grouped_by_their_numbers_not_by_their_order(
    random: Random, rays: int, cones: int
) -> None:
    names = [f"robot/left_eye_{ray}_{cone:02d}" for ray in range(rays) for cone in range(cones)]
    names += [f"lidar_{cone}" for cone in range(cones)] + ["range", "rangefinder"]
    random.shuffle(names)
    groups = group_rays(names)
    assert set(groups) == {"left_eye", "lidar"}
    assert list(groups["left_eye"]) == list(groups["lidar"]) == list(range(cones))
    for cone, members in groups["left_eye"].items():
        wanted = [f"robot/left_eye_{ray}_{cone:02d}" for ray in range(rays)]
        assert [names[member] for member in members] == wanted


@pytest.mark.parametrize("count", [2, 3, 8, 16])
@settings(max_examples=5)
@given(offset=st.floats(-180, 180).map(lambda angle: round(angle, 9)))
def test_single_rays_speak_for_the_space_up_to_the_next(
    ring_robot: RingRobot, count: int, offset: float
) -> None:
    bearings = offset + np.arange(count) * 360 / count
    ring = only_ring(ring_robot(bearings.tolist()))
    assert ring.half_angle == pytest.approx(math.pi / count, abs=1e-6)
    off = np.radians(bearings) - np.array(ring.bearings)
    np.testing.assert_allclose(np.exp(1j * off), 1, atol=1e-9)


@pytest.mark.parametrize(
    ("bearings", "half_angle"),
    [
        ([170, 190, 0, 90], 10),
        ([0, 10, 50, 120, 250], 5),
        ([37.3], 15),
        ([20, 20], 15),
        ([20, 20, 60], 20),
    ],
)
def test_uneven_rings_open_as_far_as_their_nearest_neighbours(
    ring_robot: RingRobot, bearings: Sequence[float], half_angle: float
) -> None:
    ring = only_ring(ring_robot(bearings))
    assert math.degrees(ring.half_angle) == pytest.approx(half_angle, abs=0.01)


def test_a_ring_has_the_limits_its_file_gives(ring_robot: RingRobot) -> None:
    least = '<custom><numeric name="infrared_min_range" data="0.1"/>'
    ring = only_ring(ring_robot([0, 90], ("<custom>", least)))
    assert (ring.name, ring.min_range, ring.max_range) == ("infrared", 0.1, 1.5)
    assert only_ring(ring_robot([0, 90], (' cutoff="1.5"', ""))).max_range == 10.0


def test_rays_of_one_cone_lie_side_by_side(ring_robot: RingRobot) -> None:
    for rays in (None, 3):
        robot = described("nomad200", rays)
        first = robot.rays.first
        assert robot.layout.count == len(first) == 32
        assert np.diff(first).tolist() == ([rays] * 31 if rays else [5] * 16 + [3] * 15)
        assert len(robot.rays.address) == len(np.unique(robot.rays.address))


def test_other_rangefinders_and_those_of_the_room_are_left_alone(
    ring_robot: RingRobot, own_room: Callable[..., Path]
) -> None:
    more = '<rangefinder name="downwards" site="infrared_0"/></sensor>'
    room = own_room(
        '<site name="eye" pos="0 0 0.5"/>',
        ("</mujoco>", '<sensor><rangefinder name="eye_0" site="eye"/></sensor></mujoco>'),
    )
    scene = build_scene(room, ring_robot([0, 90], ("</sensor>", more)))
    assert [ring.name for ring in scene.robot.layout.rings] == ["infrared"]
    assert scene.robot.layout.count == 2


def test_a_prefix_keeps_rings_apart_and_two_rays_that_look_alike_are_one(
    ring_robot: RingRobot,
) -> None:
    assert list(group_rays(["left/sonar_0", "right/sonar_0", "robot/sonar_1"])) == [
        "left/sonar",
        "right/sonar",
        "sonar",
    ]
    ring = described(ring_robot([0.0, 1e-6, 30.0, 60.0, 180.0])).layout.rings[0]
    assert ring.half_angle == pytest.approx(math.radians(15))


@pytest.mark.parametrize("name", ["contact", "goal", "clearance"])
def test_a_ring_cannot_hide_another_observation(ring_robot: RingRobot, name: str) -> None:
    with pytest.raises(ModelError, match=f"a ring '{name}' would hide another observation"):
        build_scene("empty_room", ring_robot(ring=name))
