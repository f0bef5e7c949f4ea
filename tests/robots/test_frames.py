"""Files that would be misread are refused in a line; what is only unusual is understood."""

import math
from collections.abc import Callable
from pathlib import Path

import pytest

import nomad_mj
from nomad_mj.errors import ModelError, NomadError
from nomad_mj.scene import build_scene

RingRobot = Callable[..., Path]
Cart = Callable[..., Path]
BASE = '<body name="base">'


def geared(gear: float) -> str:
    return "".join(
        f'<motor name="motor_{side}" joint="wheel_{side}" gear="{gear}" ctrlrange="-1 1"/>'
        for side in "lr"
    )


@pytest.mark.parametrize(
    ("edits", "told"),
    [
        ([(BASE, '<body name="base" euler="0 0 90">')], "base 'base' is not where its joints say"),
        ([(BASE, '<body name="base" euler="0 0 180">')], "must lie at the origin and look along x"),
        (
            [('site="infrared_3" cutoff="1.5"', 'site="infrared_3" cutoff="1"')],
            "rangefinder 'infrared_3' has a cutoff of 1 m, others of its ring 1.5 m",
        ),
        (
            [('<velocity name="translate"', '<motor name="translate"'), (' kv="3000"', "")],
            "actuator 'translate' takes no speed; write it as <velocity kv=...>",
        ),
    ],
)
def test_what_would_be_misread_is_refused(
    ring_robot: RingRobot, edits: list[tuple[str, str]], told: str
) -> None:
    with pytest.raises(ModelError) as caught:
        build_scene("empty_room", ring_robot(range(0, 360, 45), *edits))
    assert told in str(caught.value) and "\n" not in str(caught.value)


def test_a_welded_part_that_looks_back_is_no_base_of_a_free_robot(cart: Cart) -> None:
    front = '<body name="front" euler="0 0 3.14159265"/><body name="wheel_l" pos="0 0.125 0">'
    path = cart(
        ('<body name="wheel_l" pos="0 0.125 0">', front),
        sheet="base: front\nrings: {lidar: {count: 8, height: 0.15, body: base_link}}\n",
    )
    with pytest.raises(ModelError, match="base 'front' is not where its joints say"):
        build_scene("empty_room", path)


def test_a_touch_sensor_needs_no_name(ring_robot: RingRobot) -> None:
    path = ring_robot(range(0, 360, 45), ('<touch name="bumper_0" ', "<touch "))
    assert len(build_scene("empty_room", path).robot.bumpers) == 1


@pytest.mark.parametrize("gear", [1.0, 10.0, -4.0])
def test_servos_of_the_data_sheet_are_those_of_the_wheels_whatever_the_gear(
    cart: Cart, gear: float
) -> None:
    sheet = (
        "numbers: {servo_gain: 1, servo_max_speed: 8}\nmotors: [motor_l, motor_r]\n"
        "rings: {lidar: {count: 8, height: 0.15}}\n"
    )
    path = cart(actuators=geared(gear), sheet=sheet)
    with nomad_mj.load("motor", "empty_room", path) as env:
        assert env.task.scene.robot.limits.translate == pytest.approx(8 * 0.05)
        env.reset(seed=0, start=(3.0, 5.0, 0.0))
        speeds = env.task.scene.robot.drive.twist(0.3, 0.0, 0.0, env.task.travel)
        for _ in range(40):
            env.step(speeds)
        assert env.physics.pose().x - 3.0 == pytest.approx(0.6, abs=0.06)


@pytest.mark.parametrize(
    ("sheet", "told"),
    [
        ("rings: {infrared: [infrared_0, infrared_0]}", "names 'infrared_0' a second time"),
        ("rings: {infrared: {count: 8}}", "is to be made, but the file has 'infrared_0'"),
        ("rings: {goal: [infrared_0]}", "ring 'goal': must have a name of its own"),
    ],
)
def test_rings_that_would_meet_are_refused(ring_robot: RingRobot, sheet: str, told: str) -> None:
    path = ring_robot(range(0, 360, 45))
    path.with_suffix(".yaml").write_text(sheet)
    with pytest.raises(NomadError) as caught:
        build_scene("empty_room", path)
    assert told in str(caught.value) and "\n" not in str(caught.value)


def test_a_ring_is_what_the_data_sheet_lists_in_its_order(ring_robot: RingRobot) -> None:
    path = ring_robot(range(0, 360, 45))
    path.with_suffix(".yaml").write_text("rings: {infrared: [infrared_2, infrared_1, infrared_0]}")
    (ring,) = build_scene("empty_room", path).robot.layout.rings
    assert [round(math.degrees(bearing)) for bearing in ring.bearings] == [90, 45, 0]


def test_a_sensor_called_like_an_encoder_is_in_nobodys_way(cart: Cart) -> None:
    extra = (
        '</actuator><sensor><jointvel name="motor_l_encoder" joint="wheel_l"/></sensor><actuator>'
    )
    path = cart(("</actuator>", extra + "</actuator>"))
    assert build_scene("empty_room", path).robot.drive.kind == "differential"


@pytest.mark.parametrize("height", [0.0, 0.4, 1.0])
def test_the_height_is_that_of_the_robot_on_the_floor(cart: Cart, height: float) -> None:
    expected = build_scene("empty_room", cart()).robot.height
    path = cart(('pos="1 2 0.4"', f'pos="1 2 {height}"'))
    assert build_scene("empty_room", path).robot.height == pytest.approx(expected, abs=1e-6)
