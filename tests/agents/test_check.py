"""`nomad-mj check`: what was found, what is missing, how it drives; for every robot and rooms."""

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from nomad_agents.checks import Drift, drive_patterns, find_faults
from nomad_agents.cli.main import main

from nomad_mj.assets import list_robots
from nomad_mj.scene import build_scene

RingRobot = Callable[..., Path]
# After a square of 2 m from where it should be, and from where odometry puts it: [m], [deg].
CLOSE = {
    "nomad200": (0.001, 0.1),
    "omnibot": (0.001, 0.1),
    "nomad200_wheels": (0.01, 0.5),
    "pioneer": (0.01, 0.5),
    "khepera": (0.01, 0.5),
    "racer": (0.05, 3.0),  # it slips in its shuttles
}


def checked(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, Any], str]:
    code = main(["check", *arguments, "--json"])
    out, err = capsys.readouterr()
    return code, json.loads(out), err


def test_every_robot_is_driven_in_a_pattern() -> None:
    assert set(CLOSE) == set(list_robots())


@pytest.mark.parametrize("robot", CLOSE)
def test_test_patterns_end_where_they_should(robot: str) -> None:
    way, heading = CLOSE[robot]
    drifts: list[Drift] = drive_patterns(robot)
    assert [drift.finished for drift in drifts] == [True] * 3
    straight, turn, square = drifts
    assert straight.off_target < 0.001 and abs(math.degrees(straight.off_facing)) < 0.1
    assert abs(math.degrees(turn.off_facing)) < heading
    assert square.off_odometry < way and square.off_target < way
    assert abs(math.degrees(square.off_heading)) < heading
    assert abs(math.degrees(square.off_facing)) < heading


def test_a_robot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, found, told = checked(capsys, "pioneer", "--out", str(tmp_path), "--no-drive")
    assert found["drive"] == "differential" and found["motors"] == ["left", "right"]
    assert found["rings"] == {"sonar": 16} and found["bumpers"] == 10
    assert code == (1 if found["faults"] else 0) and found["patterns"] == []
    for word in ("a free joint", "-12.3 to 12.3", "10 30 50 90", "0.28 m"):
        assert word in told
    assert (tmp_path / "check_pioneer.png").stat().st_size > 10_000
    assert (tmp_path / "check_pioneer.pdf").stat().st_size > 5_000


def test_a_room(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, found, told = checked(capsys, "corridor", "--robot", "khepera", "--out", str(tmp_path))
    assert code == 0 and found["room"] == "corridor" and found["starts"] > 0
    assert "Nothing is missing" in told
    assert (tmp_path / "check_corridor.png").stat().st_size > 5_000


def test_a_room_beside_the_plan_it_was_made_of(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan, room = tmp_path / "plan.yaml", tmp_path / "plan.xml"
    plan.write_text("size: [6, 4]\n")
    assert main(["room", str(plan), "-o", str(room)]) == 0
    capsys.readouterr()
    code, found, _ = checked(capsys, str(room), "--out", str(tmp_path))
    assert code == 0 and found["room"] == "plan" and found["starts"] > 0


LOW = '<geom name="obstacle_low" type="box" pos="0 0 0.1" size="0.4 0.4 0.1"/>'
WALKER = (
    '<body name="moving_a" mocap="true" pos="-2 0 0.7" user="0.6 2">'
    '<geom type="cylinder" size="0.25 0.7"/></body><site name="moving_a_way_1" pos="3 0 0"/>'
)
GAP = ('size="5 0.1 0.5" pos="0 5.1 0.5"', 'size="3 0.1 0.5" pos="0 5.1 0.5"')
PILLAR = '<geom name="obstacle_pillar" type="cylinder" pos="0 0 .7" size=".3 .7"/>'


@pytest.mark.parametrize(
    ("robot", "body", "edits", "told"),
    [
        ("nomad200", LOW, (), "obstacle_low: lower than"),
        ("khepera", LOW, (), None),
        ("nomad200", "", (GAP,), "nothing keeps the robot in"),
    ],
)
def test_what_spoils_a_room_is_told(
    own_room: Callable[..., Path],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    robot: str,
    body: str,
    edits: tuple[tuple[str, str], ...],
    told: str | None,
) -> None:
    room = str(own_room(body, *edits))
    code, found, _ = checked(capsys, room, "--robot", robot, "--out", str(tmp_path))
    assert code == (told is not None) == bool(found["faults"])
    assert told is None or any(told in fault for fault in found["faults"])


def test_a_room_whose_people_cannot_walk_is_refused(
    own_room: Callable[..., Path], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    room = str(own_room(PILLAR + WALKER))
    assert main(["check", room, "--out", str(tmp_path)]) == 2
    assert "cannot walk straight from (-2, 0) to (3, 0)" in capsys.readouterr().err


def test_a_robot_that_cannot_stop_in_time_is_told(
    ring_robot: Callable[..., Path], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    robot = ring_robot(range(0, 360, 30), ('forcerange="-60 60"', 'forcerange="-6 6"'))
    code, found, _ = checked(capsys, str(robot), "--out", str(tmp_path))
    assert code == 1
    assert any("may be too weak to stop it in time" in fault for fault in found["faults"])


def test_a_robot_that_flies_apart_is_told_in_one_line(
    ring_robot: Callable[..., Path], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    light = 'mass="1e-9" diaginertia="1e-12 1e-12 1e-12"'
    robot = ring_robot(
        range(0, 360, 30),
        ('mass="20" diaginertia="1 1 1"', light),
        ('mass="5" diaginertia="0.1 0.1 0.1"', light),
    )
    code = main(["check", str(robot), "--out", str(tmp_path)])
    out, err = capsys.readouterr()
    assert code in (1, 2) and "Traceback" not in err
    assert "diverged" in out + err


def test_a_robot_too_large_for_the_room_of_the_patterns_is_told(
    ring_robot: Callable[..., Path], capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    robot = ring_robot(range(0, 360, 30), ('name="radius" data="0.2"', 'name="radius" data="1.4"'))
    assert main(["check", str(robot), "--out", str(tmp_path)]) == 2
    assert "too large to be checked, which is done in empty_room" in capsys.readouterr().err


FAULTS = {
    "large": (
        range(0, 360, 30),
        ('name="radius" data="0.2"', 'name="radius" data="0.1"'),
        "its radius is 0.1 m, but what collides reaches 0.10 m farther",
    ),
    "blind": ([0, 90], (), "no cone covers"),
    "short": (range(0, 360, 30), ('cutoff="1.5"', 'cutoff="0.9"'), "see 0.9 m, moves are up to"),
    "inside": (
        range(0, 360, 30),
        (
            '<geom name="shell"',
            '<geom size="0.4" mass="0" pos="0 0 0.3" contype="0"/><geom name="shell"',
        ),
        "rays see the robot itself",
    ),
    "numb": (range(0, 360, 30), ('<touch name="bumper_0" site="bumper"/>', ""), "no bumpers"),
}


@pytest.mark.parametrize(("bearings", "change", "told"), FAULTS.values(), ids=FAULTS.keys())
def test_what_spoils_learning_is_told(
    ring_robot: RingRobot, bearings: range, change: tuple[str, str], told: str
) -> None:
    path = ring_robot(list(bearings), *([change] if change else []))
    faults = find_faults(build_scene("empty_room", path))
    assert any(told in fault for fault in faults), faults


def test_a_robot_that_drives_backwards_is_told_of(
    ring_robot: RingRobot, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = ring_robot(range(0, 360, 30), ('gear="1 0 0 0 0 0"', 'gear="-1 0 0 0 0 0"'))
    code, found, _ = checked(capsys, str(path), "--out", str(tmp_path))
    assert code == 1
    assert any("straight, 2 m: ends 4.0" in fault for fault in found["faults"]), found["faults"]


@pytest.mark.parametrize(
    ("file", "told"),
    [
        ("nobot", "unknown robot or room 'nobot'; there are: clutter, "),
        ("no/bot.xml", "file 'no/bot.xml' does not exist"),
    ],
)
def test_mistakes_are_one_line(file: str, told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", file]) == 2
    out, err = capsys.readouterr()
    assert out == "" and told in err and err.count("\n") == 1


def test_a_folder_that_cannot_be_made(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").touch()
    assert main(["check", "corridor", "--out", str(tmp_path / "file")]) == 2
    assert "cannot write" in capsys.readouterr().err


def test_a_room_without_walls_and_with_a_dot_in_its_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    room = tmp_path / "my.v1.xml"
    sites = '<site name="goal" pos="5 3 0"/><site name="start_0" pos="1 1 0"/>'
    room.write_text(f"<mujoco><worldbody>{sites}</worldbody></mujoco>")
    assert main(["check", str(room), "--out", str(tmp_path)]) == 0
    picture = tmp_path / "check_my.v1.png"
    assert picture.exists() and str(picture) in capsys.readouterr().out.replace("\n", "")


def test_a_room_of_more_things_than_fit_is_refused_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    room = tmp_path / "many.xml"
    box = '<geom type="box" size=".1 .1 .1"/>'
    many = f'<replicate count="60000" offset="1 0 0">{box}</replicate>'
    room.write_text(f"<mujoco><worldbody>{many}</worldbody></mujoco>")
    assert main(["check", str(room), "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
