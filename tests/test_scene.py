"""Rooms and robots, the package's and a user's own, become one model without a word."""

import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest

from nomad_mj.assets import list_robots, list_rooms, models_dir
from nomad_mj.errors import ModelError, StartError
from nomad_mj.scene import CONTROL_TIMESTEP, build_scene

RingRobot = Callable[..., Path]
OwnRoom = Callable[..., Path]


@pytest.fixture(autouse=True)
def in_silence(
    capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> object:
    """Whatever happens, nothing is printed and no log is left where the user works."""
    monkeypatch.chdir(tmp_path)
    before = set(tmp_path.iterdir())
    yield
    out, err = capfd.readouterr()
    assert (out, err) == ("", "")
    assert set(tmp_path.iterdir()) - before <= {tmp_path / "own"}


@pytest.mark.parametrize("room", list_rooms())
@pytest.mark.parametrize("robot", list_robots())
def test_every_room_takes_every_robot(room: str, robot: str) -> None:
    scene = build_scene(room, robot)
    assert scene.robot.name == robot and scene.arena.name == room
    assert scene.model.opt.timestep == 0.005
    assert scene.free_space.contains_properly(scene.free_space.representative_point())
    rays = scene.model.sensor_type == mujoco.mjtSensor.mjSENS_RANGEFINDER
    assert (scene.model.sensor_interval[rays, 0] < CONTROL_TIMESTEP).all()
    assert (scene.model.sensor_history[rays, 0] == 1).all()
    touch = scene.model.sensor_type == mujoco.mjtSensor.mjSENS_TOUCH
    assert (scene.model.sensor_history[touch, 0] == 10).all()


def test_a_file_of_ones_own_may_bring_options_which_the_scene_overrules(
    own_room: OwnRoom, ring_robot: RingRobot
) -> None:
    head = '<option timestep="0.02" gravity="0 0 -1"/><size memory="1M"/>'
    option = ('integrator="implicitfast"', 'timestep="0.001" integrator="RK4"')
    keyframe = ("</mujoco>", '<keyframe><key name="there" qpos="1 1 0 0"/></keyframe></mujoco>')
    model = build_scene(own_room(head=head), ring_robot([0], option, keyframe)).model
    own = mujoco.MjModel.from_xml_path(str(models_dir() / "scene.xml"))
    assert model.opt.timestep == own.opt.timestep == 0.005
    assert model.opt.integrator == own.opt.integrator
    assert model.opt.gravity.tolist() == own.opt.gravity.tolist()


def test_a_room_may_have_moving_things_and_angles_in_radians(own_room: OwnRoom) -> None:
    ball = '<body name="ball" pos="1 1 0.3"><freejoint/><geom name="obstacle_b" size="0.3"/></body>'
    start = '<site name="start_turned" pos="0 0 0" euler="0 0 1.5"/>'
    scene = build_scene(own_room(ball + start, head='<compiler angle="radian"/>'), "nomad200")
    assert scene.arena.start_names == ("start_0", "start_turned")
    assert scene.arena.starts[1, 2] == pytest.approx(1.5)
    assert not scene.free_space.contains(scene.free_space.__class__([(1, 1), (1.1, 1), (1, 1.1)]))


def test_files_that_a_room_refers_to_are_found_beside_it(tmp_path: Path, own_room: OwnRoom) -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype="<f4")
    faces = [corners[list(face)] for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))]
    triangles = b"".join(struct.pack("<3f", 0, 0, 0) + f.tobytes() + b"\0\0" for f in faces)
    folder = tmp_path / "own"
    folder.mkdir()
    (folder / "wedge.stl").write_bytes(bytes(80) + struct.pack("<I", 4) + triangles)
    body = '<geom name="obstacle_wedge" type="mesh" mesh="wedge" pos="0 0 0.2"/>'
    made = own_room(body, head='<asset><mesh name="wedge" file="wedge.stl"/></asset>')
    (folder / "room.xml").write_text(made.read_text())
    scene = build_scene(folder / "room.xml", "nomad200")
    assert scene.plan.nearest_name(np.array([0.2, 0.2])) == "obstacle_wedge"


def wrong(reader: str, room: str | Path, robot: str | Path, *words: str) -> None:
    with pytest.raises((ModelError, StartError)) as caught:
        build_scene(room, robot)
    message = str(caught.value)
    assert "\n" not in message and message.startswith(reader), message
    for word in words:
        assert word in message, message


MALFORMED = {
    "empty": ("room.xml", b"", "empty file"),
    "binary": ("room.xml", bytes(range(256)) * 8, "XML parse error"),
    "truncated": ("room.xml", b"<mujoco><worldbody><geom", "Line number"),
    "picture": ("room.png", b"\x89PNG\r\n\x1a\n" + bytes(64), "decoder"),
    "no ending": ("room", b"<mujoco/>", "decoder"),
    "latin-1": ("room.xml", b"<mujoco><option caf\xe9='1'/></mujoco>", ""),
    "element": ("room.xml", b"<mujoco><worldbody><goem/></worldbody></mujoco>", "'goem', line 1"),
    "attribute": ("room.xml", b"<mujoco><option tempo='1'/></mujoco>", "'tempo'"),
    "value": ("room.xml", b"<mujoco><option timestep='x'/></mujoco>", "'timestep'"),
    "include": ("room.xml", b"<mujoco><include file='nope.xml'/></mujoco>", "nope.xml"),
    "part": ("room.xml", b"<mujocoinclude/>", "mujocoinclude"),
    "not a number": (
        "room.xml",
        b"<mujoco><worldbody><site name='goal' pos='nan 0 0'/></worldbody></mujoco>",
        "NaN",
    ),
}


@pytest.mark.parametrize("kind", ["room", "robot"])
@pytest.mark.parametrize(("name", "content", "word"), MALFORMED.values(), ids=MALFORMED.keys())
def test_a_malformed_file_is_named_with_what_is_wrong_in_it(
    kind: str, name: str, content: bytes, word: str, tmp_path: Path
) -> None:
    (tmp_path / "own").mkdir()
    path = tmp_path / "own" / name
    path.write_bytes(content)
    room, robot = (path, "nomad200") if kind == "room" else ("paper_room", path)
    wrong(f"{kind} file {str(path)!r} ", room, robot, word)


def test_a_room_without_goal_or_start_is_refused(own_room: OwnRoom) -> None:
    for site in ("goal", "start_0"):
        made = own_room("", (f'"{site}"', '"elsewhere"'), name="bare")
        wrong("room 'bare' has no site", made, "nomad200", site.removesuffix("_0"), "elsewhere")


def test_a_start_or_goal_in_an_obstacle_is_refused_by_name(own_room: OwnRoom) -> None:
    for site, x in (("goal", 3), ("start_0", -3)):
        box = f'<geom name="obstacle_x" type="box" size="0.5 0.5 0.5" pos="{x} {x} 0.5"/>'
        wrong("room 'own'", own_room(box), "nomad200", site, "obstacle_x", "0.765 m")


def test_a_goal_that_cannot_be_reached_is_refused(own_room: OwnRoom) -> None:
    barrier = '<geom name="obstacle_0" type="box" size="5 0.1 0.5" pos="0 0 0.5"/>'
    wrong("room 'own'", own_room(barrier), "nomad200", "cannot reach the goal", "start_0", "0.53 m")


def test_who_asks_for_a_goal_outside_the_walls_is_told_where_the_floor_is(
    own_room: OwnRoom,
) -> None:
    corners = "".join(
        f'<geom name="wall_corner{x}5{y}5" type="box" size="0.2 0.2 0.5" pos="{x}5.1 {y}5.1 0.5"/>'
        for x in ("", "-")
        for y in ("", "-")
    )
    away = ('pos="3 3 0"', 'pos="30 3 0"')
    wrong("room 'own'", own_room(corners, away), "nomad200", "cannot reach", "-5 to 5 m in x")
    wrong("room 'own'", own_room("", away), "nomad200", "cannot reach", "a passage")  # open there


def test_a_room_is_no_robot_and_a_robot_no_room(own_room: OwnRoom) -> None:
    wrong("robot 'paper_room'", "paper_room", list_rooms()["paper_room"], "no drive")
    wrong("room 'nomad200'", list_robots()["nomad200"], "nomad200", "'goal'")


@pytest.mark.parametrize("robot", [*list_robots(), "puck"])
def test_a_scene_of_a_name_is_the_scene_of_its_file(robot: str, ring_robot: RingRobot) -> None:
    path = list_robots().get(robot) or ring_robot()
    by_file = build_scene(list_rooms()["corridor"], path)
    by_name = build_scene("corridor", robot if robot in list_robots() else str(path))
    assert by_name.robot.layout == by_file.robot.layout
    assert by_name.model.nsensor == by_file.model.nsensor
    np.testing.assert_array_equal(by_name.model.geom_pos, by_file.model.geom_pos)


def test_the_engine_is_silent_from_a_fresh_process_too(own_room: OwnRoom, tmp_path: Path) -> None:
    made = own_room(head='<option timestep="0.02"/>')
    code = f"import nomad_mj; nomad_mj.load('motor', room={str(made)!r}).close()"
    root = Path(__file__).resolve().parents[1]
    ran = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        env={"PYTHONPATH": f"{root}", "PATH": "/usr/bin:/bin", "MUJOCO_GL": "off"},
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, "", "")


def test_a_rooms_own_floor_and_lights_serve_where_it_is_alone(own_room: OwnRoom) -> None:
    floor = '<light pos="0 0 3"/><geom name="ground" type="plane" size="5 5 .1" friction="1"/>'
    plain, dressed = build_scene(own_room(), "nomad200"), build_scene(own_room(floor), "nomad200")
    assert dressed.model.ngeom == plain.model.ngeom and dressed.model.nlight == plain.model.nlight


def test_a_plane_that_is_no_floor_is_refused(own_room: OwnRoom) -> None:
    raised = own_room('<geom name="stage" type="plane" size="1 1 .1" pos="0 0 .3"/>')
    with pytest.raises(ModelError, match="plane 'stage' is no floor at height 0; write"):
        build_scene(raised, "nomad200")


def test_a_slope_through_the_origin_is_refused(own_room: OwnRoom) -> None:
    slope = own_room('<geom name="slope" type="plane" size="5 5 .1" euler="10 0 0"/>')
    with pytest.raises(ModelError, match=r"'(room/)?slope'"):
        build_scene(slope, "nomad200")
