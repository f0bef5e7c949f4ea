"""The messages that the pages list are those that a user's mistakes really bring."""

import re
from pathlib import Path
from typing import Any

import pytest
from nomad_agents.cli.main import main

import nomad_mj
from nomad_mj.errors import NomadError

DOCS = Path(__file__).resolve().parents[2] / "docs"
ROOM = (
    ('name="goal"', 'name="gaol"', "has no site named 'goal'; sites there are: "),
    ('name="start_', 'name="begin_', "has no site whose name begins with 'start'"),
    ('pos="1 1 0"', 'pos="3 1.6 0"', "overlaps 'obstacle_post' by "),
    ('size="0.4 0.45"', 'size="1.9 0.45"', "cannot reach the goal "),
    ("</worldbody>", "", "is not valid MJCF: "),
)
MOVING = (
    (' mocap="true" pos="3 3', ' pos="3 3', 'cannot move: give it mocap="true"'),
    (
        '<site name="goal"/>',
        '<site name="goal"/><geom name="flag" size="0.1"/>',
        "moves with the goal, so nothing may run into it",
    ),
    ('pos="3 3 0.45"', 'pos="4.6 3 0.45"', "is outside the room, in something or nearer the goal"),
    (
        '3 3 0.45" euler="0 0 -90">\n      <geom name="obstacle_post" type="cylinder" size="0.25 ',
        '2 2 0.45">\n      <geom name="obstacle_post" type="cylinder" size="1.9 ',
        "no place found for moving obstacle ",
    ),
)
ROBOT = (
    (
        '<velocity name="turret"',
        '<velocity name="tower"',
        "lacks the actuator 'turret'; actuators it has: translate, steer",
    ),
    (
        'name="steer" axis="0 0 1"',
        'name="steer" type="slide" axis="0 0 1"',
        "joint 'steer' must be a hinge",
    ),
    ('ctrlrange="-0.5 0.5"', "", "actuator 'translate' needs a ctrlrange"),
    (
        '<rangefinder name="lidar" site="lidar" cutoff="3"/>',
        "",
        "has no range sensor: add rangefinders named <ring>_<ray>_<cone>",
    ),
    (
        "</custom>",
        '<numeric name="lidar_min_range" data="4"/></custom>',
        "lidar_min_range 4 m must be below the cutoff of its rangefinders, 3 m",
    ),
    (
        '<joint name="turret" axis="0 0 1"/>',
        '<joint name="turret" axis="0 0 1"/></body><body name="mast" pos="0 0 0.35">',
        "the sites of 'lidar' must be in the body 'turret'",
    ),
    ('data="0.2"', 'data="0.5"', "a robot of radius 0.5 m at site "),
)


CART = (
    ("[left_motor,", "[left,", "has no actuator 'left'; there are: left_motor, right_motor"),
    ("motors:", "# ", "has no drive: it needs velocity servos"),
)


def model(page: str, number: int = 0) -> str:
    found = re.findall(r"```xml\n(.*?)```", (DOCS / page).read_text(), re.DOTALL)
    return found[number]


def error_of(**files: Any) -> str:
    with pytest.raises(NomadError) as raised:
        nomad_mj.load("path_finding", **files)
    message = str(raised.value)
    assert "\n" not in message
    return message


@pytest.mark.parametrize(
    ("kind", "old", "new", "told"),
    [("room", *case) for case in ROOM] + [("robot", *case) for case in ROBOT],
)
def test_mistakes_bring_the_message_of_the_page(
    kind: str, old: str, new: str, told: str, tmp_path: Path
) -> None:
    page = f"your-own-{kind}.md"
    text = model(page, {"room": 0, "robot": 1}[kind])
    assert old in text
    (tmp_path / "own.xml").write_text(text.replace(old, new))
    assert told in error_of(**{kind: tmp_path / "own.xml"})
    assert f"`{told}`" in (DOCS / page).read_text()


@pytest.mark.parametrize(("old", "new", "told"), CART)
def test_mistakes_in_a_data_sheet_do_too(old: str, new: str, told: str, tmp_path: Path) -> None:
    page = (DOCS / "your-own-robot.md").read_text()
    sheet = re.findall(r"```yaml\n(.*?)```", page, re.DOTALL)[0]
    assert old in sheet
    (tmp_path / "cart.xml").write_text(model("your-own-robot.md"))
    (tmp_path / "cart.yaml").write_text(sheet.replace(old, new))
    assert told in error_of(robot=tmp_path / "cart.xml")
    assert f"`{told}`" in page


def test_a_robot_that_is_fixed(tmp_path: Path) -> None:
    text = model("your-own-robot.md", 1)
    (tmp_path / "own.xml").write_text(text.replace('type="slide" axis="1 0 0"', 'axis="1 0 0"'))
    told = "cannot go everywhere: give it a free joint"
    assert told in error_of(robot=tmp_path / "own.xml")
    assert f"`{told}`" in (DOCS / "your-own-robot.md").read_text()


@pytest.mark.parametrize(("old", "new", "told"), MOVING)
def test_mistakes_with_what_moves_do_too(old: str, new: str, told: str, tmp_path: Path) -> None:
    text = model("your-own-room.md", 1)
    assert old in text
    (tmp_path / "own.xml").write_text(text.replace(old, new))
    assert told in error_of(room=tmp_path / "own.xml")
    assert f"`{told}`" in (DOCS / "your-own-room.md").read_text()


@pytest.mark.parametrize(
    ("room", "told"),
    [
        ("my_rom", "unknown room 'my_rom'; there are: "),
        ("my_rom.xml", "room file 'my_rom.xml' does not exist"),
    ],
)
def test_a_room_that_is_not_there(room: str, told: str) -> None:
    assert told in error_of(room=room)
    assert f"`{told}`" in (DOCS / "your-own-room.md").read_text()


def test_a_ring_that_loses_echoes_and_is_not_there(tmp_path: Path) -> None:
    (tmp_path / "own.xml").write_text(model("your-own-robot.md", 1))
    noise = {"range_noise": nomad_mj.RangeNoise(grazing=0.5)}
    told = error_of(robot=tmp_path / "own.xml", task_kwargs=noise)
    assert told == "specular ring 'sonar': the robot has no such ring; rings it has: lidar"
    assert f"`{told}`" in (DOCS / "your-own-robot.md").read_text()


def test_a_checkpoint_for_other_sensors(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot, checkpoint = tmp_path / "my_robot.xml", tmp_path / "few.npz"
    robot.write_text(model("your-own-robot.md", 1))
    assert main(["train", "--max-decisions", "1", "--out", str(checkpoint)]) == 0
    assert main(["evaluate", "--agent", str(checkpoint), "--robot", str(robot)]) == 2
    assert "is for other sensors: " in capsys.readouterr().err
    assert "`is for other sensors: `" in (DOCS / "your-own-robot.md").read_text()
