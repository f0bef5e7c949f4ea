"""A robot's file that knows nothing of this package attaches, drives and learns."""

import math
import shutil
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from nomad_agents.checks import calibrate, drive_patterns

import nomad_mj
from nomad_mj.assets import models_dir
from nomad_mj.errors import ModelError
from nomad_mj.scene import build_scene

Cart = Callable[..., Path]
TORQUE = "".join(
    f'<motor name="motor_{side}" joint="wheel_{side}" ctrlrange="-1 1"/>' for side in "lr"
)
LIDAR = "rings: {lidar: {count: 8, height: 0.15, half_angle: 22.5}}\n"


def test_what_belongs_to_a_scene_stays_away(cart: Cart) -> None:
    model = build_scene("empty_room", cart()).model
    scene = mujoco.MjModel.from_xml_path(str(models_dir() / "scene.xml"))
    assert model.opt.timestep == scene.opt.timestep
    assert model.vis.global_.offwidth == scene.vis.global_.offwidth
    assert model.nlight == scene.nlight and model.nkey == 0 and model.npair == 0
    geoms = [model.geom(i).name for i in range(model.ngeom)]
    assert "robot/chassis" in geoms and "robot/floor" not in geoms and "robot/wall" not in geoms
    skies = [t for t in model.tex_type if t == mujoco.mjtTexture.mjTEXTURE_SKYBOX]
    assert len(skies) == 1


def test_what_it_offers_is_measured(cart: Cart) -> None:
    robot = build_scene("empty_room", cart()).robot
    assert robot.drive.kind == "differential" and robot.footing.free
    assert robot.layout.radius == pytest.approx(math.hypot(0.14, 0.1), abs=1e-3)
    assert robot.limits.translate == pytest.approx(15 * 0.05)
    assert robot.limits.turn == pytest.approx(15 * 0.05 / 0.125)
    (ring,) = robot.layout.rings
    assert (len(ring.bearings), ring.min_range, ring.max_range) == (24, 0.02, 4.0)
    np.testing.assert_allclose(np.degrees(ring.half_angle), 7.5)
    assert robot.bumpers == ()


def test_it_stands_where_it_is_put_whatever_its_file_says(cart: Cart) -> None:
    with nomad_mj.load("motor", "empty_room", cart()) as env:
        env.reset(seed=0, start=(3.0, 4.0, 1.2))
        pose = env.physics.pose()
        assert pose == pytest.approx((3.0, 4.0, 1.2), abs=1e-9)
        step = env.step((0.0, 0.0))
        for _ in range(20):
            step = env.step((0.0, 0.0))
        assert env.physics.pose() == pytest.approx((3.0, 4.0, 1.2), abs=2e-3)
        # The walls of the room, from the perimeter, as far as the lidar sees.
        lidar = step.observation["lidar"]
        assert lidar.max() <= 4.0 and lidar.min() > 2.3


def test_it_drives_where_its_odometry_says(cart: Cart) -> None:
    straight, turn, square = drive_patterns(cart())
    assert straight.finished and straight.off_odometry < 0.01
    assert abs(turn.off_heading) < math.radians(5)
    assert square.finished and square.off_odometry < 0.15


def test_check_tells_the_numbers_that_make_odometry_right(cart: Cart) -> None:
    wrong = cart(sheet=f"numbers: {{wheel_radius: 0.06, track: 0.2}}\n{LIDAR}")
    first = drive_patterns(wrong)
    numbers = calibrate(build_scene("empty_room", wrong), first)
    assert numbers["wheel_radius"] == pytest.approx(0.05, rel=0.02)
    assert numbers["track"] == pytest.approx(0.25, rel=0.05)
    told = ", ".join(f"{name}: {value}" for name, value in numbers.items())
    straight, turn, _ = drive_patterns(cart(sheet=f"numbers: {{{told}}}\n{LIDAR}"))
    assert first[0].off_odometry > 0.2 and straight.off_odometry < 0.02
    assert abs(turn.off_heading) < math.radians(5) < abs(first[1].off_heading)


def test_a_rover_that_scrubs_is_calibrated_by_what_check_tells(tmp_path: Path) -> None:
    rover, sheet = tmp_path / "rover.xml", tmp_path / "rover.yaml"
    shutil.copy(Path(__file__).parent / "rover.xml", rover)
    ring = "rings: {lidar: {count: 24, height: 0.15, half_angle: 7.5, range: [0.02, 4]}}\n"
    offs: list[float] = []
    tracks = [0.32]  # as the wheels stand
    for _ in range(3):  # what turns slower slips otherwise, so the first advice is not yet the last
        sheet.write_text(f"numbers: {{track: {tracks[-1]}}}\n{ring}")
        drifts = drive_patterns(rover)
        _, turn, square = drifts
        assert turn.finished and square.finished
        offs.append(abs(turn.off_heading))
        tracks.append(calibrate(build_scene("empty_room", rover), drifts).get("track", tracks[-1]))
    assert offs[0] > math.radians(180)  # less than half of the turn: more than half is missing
    assert offs[1] < math.radians(20) and offs[2] < math.radians(3)
    assert tracks[-1] == pytest.approx(0.735, abs=0.03)


def test_it_carries_out_moves(cart: Cart) -> None:
    with nomad_mj.load("path_finding", "empty_room", cart()) as env:
        step = env.reset(seed=1, start=(2.0, 2.0))
        before = math.hypot(*step.observation["goal"])
        for _ in range(3):
            step = env.step((1.0, 0.0))
        assert math.hypot(*step.observation["goal"]) == pytest.approx(before - 3.0, abs=0.05)


def test_the_names_of_a_data_sheet_are_those_of_the_file(cart: Cart) -> None:
    sheet = "drive: differential\nmotors: [motor_r, motor_l]\nbase: base_link\n" + LIDAR
    assert build_scene("empty_room", cart(sheet=sheet)).robot.drive.motors == (
        "motor_r",
        "motor_l",
    )


def test_torque_motors_become_servos(cart: Cart) -> None:
    numbers = "motors: [motor_l, motor_r]\nnumbers: {servo_gain: 1, servo_max_speed: 10}\n"
    robot = build_scene("empty_room", cart(sheet=numbers + LIDAR, actuators=TORQUE)).robot
    assert robot.limits.translate == pytest.approx(0.5)
    straight, *_ = drive_patterns(cart(sheet=numbers + LIDAR, actuators=TORQUE))
    assert straight.finished and straight.off_target < 0.04


def test_names_of_motors_may_hold_spaces(cart: Cart) -> None:
    sheet = "motors: [motor l, motor r]\n" + LIDAR
    servos = "".join(
        f'<velocity name="motor {side}" joint="wheel_{side}" kv="1" ctrlrange="-15 15"/>'
        for side in "lr"
    )
    robot = build_scene("empty_room", cart(sheet=sheet, actuators=servos)).robot
    assert robot.drive.motors == ("motor l", "motor r")


def test_numbers_of_the_data_sheet_go_before_those_of_the_file(cart: Cart) -> None:
    numbers = "numbers: {radius: 0.21, wheel_radius: 0.06, track: 0.3, turn_max_speed: 1}\n"
    file = ("<actuator>", '<custom><numeric name="radius" data="0.5"/></custom><actuator>')
    robot = build_scene("empty_room", cart(file, sheet=numbers + LIDAR)).robot
    assert robot.layout.radius == 0.21 and robot.limits.turn == 1
    left, right = robot.drive.rows  # type: ignore[attr-defined]
    assert abs(left[2] - right[2]) == pytest.approx(0.3)
    assert robot.limits.translate == pytest.approx(0.9)


def test_a_motor_that_is_mounted_the_other_way_round_drives_alike(cart: Cart) -> None:
    right = 'name="motor_r" joint="wheel_r"'
    turned = cart((right, f'{right} gear="-1"'))
    robot = build_scene("empty_room", turned).robot
    assert robot.limits.translate == pytest.approx(15 * 0.05)
    straight, *_ = drive_patterns(turned)
    assert straight.finished and straight.off_odometry < 0.01


WRONG = {
    "no ring": ("base: base_link", "has no range sensor"),
    "no such motor": (
        "motors: [left, motor_r]\n" + LIDAR,
        "no actuator 'left'; there are: motor_l",
    ),
    "no such base": ("base: trunk\n" + LIDAR, "no body 'trunk'; there are: base_link"),
    "no such finder": ("rings: {lidar: [front]}", "no rangefinder 'front'; there are: none"),
    "other drive": ("drive: omni\n" + LIDAR, "said to be omni"),
    "no synchro": ("drive: synchro\n" + LIDAR, "lacks the actuator 'translate'"),
    "no car": ("drive: car\n" + LIDAR, "lacks the actuator 'drive'"),
    "kind": ("drive: legs\n" + LIDAR, "must be one of synchro, differential, omni, car"),
    "key": ("wheels: 2\n" + LIDAR, "knows no 'wheels'; there are: drive, base, motors"),
    "number": ("numbers: {radius: wide}\n" + LIDAR, "radius 'wide': must be a number"),
    "no such number": (
        "numbers: {wheel_radios: 1}\n" + LIDAR,
        "numbers knows no 'wheel_radios'; there are: radius, translate_max_speed",
    ),
    "radius": ("numbers: {radius: 0}\n" + LIDAR, "its radius is 0; it must be above 0"),
    "ring": ("rings: {lidar: {height: 1}}", "needs count, or bearings"),
    "numbered ring": ("rings: {lidar_1: {count: 8}}", "'lidar_1': must not end in a number"),
    "part of a ray": ("rings: {lidar: {count: 8.9}}", "count 8.9: must be a whole number"),
    "rays": ("rings: {lidar: {count: 0}}", "count 0: must be a number from 1 to 720"),
    "range": ("rings: {lidar: {count: 8, range: [2, 1]}}", "range [2, 1]: must be the least"),
    "roles": ("drive: car\nmotors: [a, b]\n" + LIDAR, "has roles; write {drive: ..., steer: ...}"),
    "yaml": ("drive: [", "is not valid YAML"),
    "text": ("wheels", "must hold keys and values, such as drive: differential"),
    "body": ("rings: {lidar: {count: 8, body: mast}}", "no body 'mast'; there are: base_link"),
}


@pytest.mark.parametrize(("sheet", "told"), WRONG.values(), ids=WRONG.keys())
def test_mistakes_in_a_data_sheet_are_one_line(cart: Cart, sheet: str, told: str) -> None:
    with pytest.raises(ModelError) as caught:
        build_scene("empty_room", cart(sheet=sheet))
    message = str(caught.value)
    assert told in message and "\n" not in message


BELT = '<tendon><fixed name="belt"><joint joint="wheel_l" coef="1"/></fixed></tendon>'
FILES = {
    "torque": (("velocity", "motor"), ('kv="1"', ""), "takes no speed; write it as <velocity"),
    "no gear": (('kv="1"', 'kv="1" gear="0"'), ("", ""), "has no gear, so it moves nothing"),
    "no range": ((' ctrlrange="-15 15"', ""), ("", ""), "needs a ctrlrange"),
    "fixed": (
        ('<freejoint name="root"/>', ""),
        ('<keyframe><key name="home" qpos="0 0 0.1 1 0 0 0 0 0"/></keyframe>', ""),
        "'base_link' cannot go everywhere",
    ),
    "tendon": (
        ("<actuator>", f"{BELT}<actuator>"),
        ('joint="wheel_l" kv="1"', 'tendon="belt" kv="1"'),
        "must act on a joint, or on a site",
    ),
    "two": (
        ("</worldbody>", '<body name="table"><geom size="1"/></body></worldbody>'),
        ("", ""),
        "several bodies that could be its base: base_link, table",
    ),
}


@pytest.mark.parametrize(("first", "second", "told"), FILES.values(), ids=FILES.keys())
def test_what_is_missing_in_the_file_is_told(
    cart: Cart, first: tuple[str, str], second: tuple[str, str], told: str
) -> None:
    named = "speed" in told or "act on" in told
    sheet = LIDAR + ("motors: [motor_l, motor_r]\n" if named else "")
    with pytest.raises(ModelError) as caught:
        build_scene("empty_room", cart(first, second, sheet=sheet))
    message = str(caught.value)
    assert told in message and message.startswith("robot 'cart'") and "\n" not in message


def test_a_sheet_called_robot_serves_every_file_of_its_folder(cart: Cart) -> None:
    path = cart()
    path.with_suffix(".yaml").rename(path.with_name("robot.yaml"))
    assert build_scene("empty_room", path).robot.layout.rings[0].name == "lidar"
