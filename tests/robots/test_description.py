"""A robot is what its compiled file says, and what is missing from it is named."""

from collections.abc import Callable
from pathlib import Path

import pytest

from nomad_mj.errors import ModelError
from nomad_mj.scene import build_scene

RingRobot = Callable[..., Path]


@pytest.mark.parametrize("robot", ["nomad200", "nomad200_wheels"])
def test_both_drives_are_one_robot_to_the_tasks(robot: str) -> None:
    planar = build_scene("empty_room", "nomad200").robot
    other = build_scene("empty_room", robot).robot
    assert other.name == robot
    assert other.layout == planar.layout
    assert other.limits == planar.limits
    assert other.bumpers == planar.bumpers == tuple(f"bumper_{i}" for i in range(20))
    assert other.height == pytest.approx(planar.height, abs=0.02)


def test_numbers_are_read_from_the_file(ring_robot: RingRobot) -> None:
    more = '<custom><numeric name="steer_max_acceleration" data="1.25"/>'
    robot = build_scene("empty_room", ring_robot([0], ("<custom>", more))).robot
    assert robot.layout.radius == 0.2
    assert robot.limits.translate == 0.5 and robot.limits.turn == 1.0
    assert robot.limits.turn_acceleration == 1.25
    assert robot.height == pytest.approx(0.15)
    assert robot.bumpers == ("bumper_0",)


def test_a_robot_may_be_slower_than_its_motors(ring_robot: RingRobot) -> None:
    slow = '<custom><numeric name="translate_max_speed" data="0.3"/>'
    slow += '<numeric name="turn_max_speed" data="0.7"/>'
    limits = build_scene("empty_room", ring_robot([0], ("<custom>", slow))).robot.limits
    assert (limits.translate, limits.turn) == (0.3, 0.7)


def test_bumpers_may_be_missing(ring_robot: RingRobot) -> None:
    path = ring_robot([0], ('<touch name="bumper_0" site="bumper"/>', ""))
    assert build_scene("empty_room", path).robot.bumpers == ()


BAD = {
    "no translate": (
        'name="translate"',
        'name="go"',
        "lacks the actuator 'translate'",
        "go, steer",
    ),
    "no turret": ('<velocity name="turret"', '<velocity name="head"', "actuator 'turret'", "head"),
    "no joint": ('<joint name="base_y" type="slide" axis="0 1 0"/>', "", "'base'", "free joint"),
    "no rays": (
        '<rangefinder name="infrared_',
        '<rangefinder name="eye',
        "no range sensor",
        "eye0",
    ),
    "radius 0": ('data="0.2"', 'data="0"', "radius is 0", "above 0"),
    "radius < 0": ('data="0.2"', 'data="-2"', "radius is -2", "above 0"),
    "no limits": (' ctrlrange="-0.5 0.5"', "", "actuator 'translate'", "needs a ctrlrange"),
    "ball": ('type="slide" axis="1 0 0"', 'type="ball"', "'base'", "slide joints along x and y"),
    "down": (
        'joint name="steer" axis="0 0 1"',
        'joint name="steer" axis="0 0 -1"',
        "'steer'",
        "up",
    ),
    "gear": (
        '<intvelocity name="steer"',
        '<intvelocity gear="-1" name="steer"',
        "actuator 'steer' must turn to the left",
        "its gear be above 0",
    ),
    "fixed ring": (
        '<joint name="turret" axis="0 0 1"/>',
        '<joint name="turret" axis="0 0 1"/></body><body name="fixed" pos="0 0 0.3">',
        "the sites of 'infrared'",
        "in the body 'turret'",
    ),
    "least": ("<custom>", '<custom><numeric name="infrared_min_range" data="2"/>', "2 m", "1.5 m"),
}


@pytest.mark.parametrize(("old", "new", "what", "right"), BAD.values(), ids=BAD.keys())
def test_what_is_wrong_is_named_with_what_would_be_right(
    ring_robot: RingRobot, old: str, new: str, what: str, right: str
) -> None:
    path = ring_robot([0, 90], (old, new), name="wrong")
    with pytest.raises(ModelError) as caught:
        build_scene("empty_room", path)
    message = str(caught.value)
    assert message.startswith("robot 'wrong'") and "\n" not in message
    assert what in message and right in message
