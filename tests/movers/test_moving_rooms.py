"""Moving bodies in the file of a room: read, refused, and driven."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nomad_mj import MotorEnvironment, MovingGoal, MovingObstacles, NomadError, list_rooms, load
from nomad_mj.errors import ModelError, StartError
from nomad_mj.scene import build_scene

OwnRoom = Callable[..., Path]
BOX = '<geom type="box" size="0.3 0.4 0.5"/>'
GOAL = ('<site name="goal" pos="3 3 0"/>', "")
HOME = np.array([1.0, -2.0])


def body(inside: str = BOX, name: str = "moving_box", more: str = 'mocap="true"') -> str:
    return f'<body name="{name}" pos="1 -2 0.5" euler="0 0 90" {more}>{inside}</body>'


def goal(inside: str = "", name: str = "flag") -> str:
    site = '<site name="goal" pos="0 -1 0.01"/>'
    return f'<body name="{name}" mocap="true" pos="2 3 0" euler="0 0 90">{site}{inside}</body>'


def drive(room: Path, **options: Any) -> MotorEnvironment:
    kwargs = {"random": 0, "ends_at_goal": False} | options
    return load("motor", room=room, task_kwargs=kwargs)


def test_a_mocap_body_called_moving_moves_along_its_x_axis(own_room: OwnRoom) -> None:
    env = drive(own_room(body()))
    (found,) = env.task.scene.moving.obstacles
    assert found.name == "moving_box" and found.radius == pytest.approx(0.5)
    assert found.drift.direction == pytest.approx(math.pi / 2)
    assert found.drift.speed == pytest.approx(0.305)
    assert "moving_box" not in env.task.scene.plan.names and len(env.task.scene.plan.names) == 4
    env.reset()
    assert env.task.movers is not None
    np.testing.assert_allclose(env.task.movers.obstacles, HOME[None])
    for _ in range(100):
        env.step(np.zeros(3))
    drawn = env.physics.named.data.xpos["room/moving_box"]
    assert drawn[1] > -1.9 and drawn[2] == 0.5
    np.testing.assert_allclose(drawn[:2], env.task.movers.obstacles[0])
    env.reset()
    np.testing.assert_allclose(env.task.movers.obstacles, HOME[None])
    env.close()


def test_a_robot_that_starts_there_has_it_start_elsewhere(own_room: OwnRoom) -> None:
    env = drive(own_room(body()))
    env.reset(start=(1.5, -2.0))
    assert env.task.movers is not None
    assert math.dist(env.task.movers.obstacles[0], (1.5, -2.0)) >= 0.5 + 0.265 + 0.5
    env.close()


def test_a_goal_on_a_mocap_body_moves_with_it(own_room: OwnRoom) -> None:
    sign = '<geom type="box" size="0.1 0.1 0.5" contype="0" conaffinity="0"/>'
    env = drive(own_room(goal(sign), GOAL))
    moving = env.task.scene.moving
    assert moving.goal is not None and moving.goal.name == "flag" and not moving.obstacles
    assert moving.goal.drift.direction == pytest.approx(math.pi / 2)
    told = env.reset(start=0).observation
    np.testing.assert_allclose(env.task.goal, (3, 3))
    for _ in range(100):
        told = env.step(np.zeros(3)).observation
    np.testing.assert_allclose(told["goal"] + told["odometry"][:2], env.task.goal)
    assert env.task.goal[1] > 3.1
    drawn = env.physics.named.data.site_xpos["room/goal"]
    np.testing.assert_allclose(drawn, [*env.task.goal, 0.01])
    env.close()


@pytest.mark.parametrize("wrapped", [False, True])
@pytest.mark.parametrize("nested", [False, True])
def test_options_say_more_than_the_file(own_room: OwnRoom, wrapped: bool, nested: bool) -> None:
    flag = goal()
    if nested:
        flag = flag.replace("<site", '<body pos="0 0 0"><site').replace("</body>", "</body></body>")
    if wrapped:
        flag = f'<frame pos="2 3 0" euler="0 0 30"><frame pos="-2 -3 0">{flag}</frame></frame>'
    elsewhere = load("motor", room=own_room(body() + flag, GOAL), goal=(-2.0, 1.5))
    np.testing.assert_allclose(elsewhere.task.scene.arena.goal, (-2.0, 1.5), atol=1e-12)
    before = build_scene(own_room(flag, GOAL), "nomad200").moving.goal
    after = elsewhere.task.scene.moving.goal
    assert before is not None and after is not None
    assert after.drift.direction == pytest.approx(before.drift.direction)
    elsewhere.close()
    env = drive(
        own_room(body() + flag, GOAL),
        moving_goal=MovingGoal(speed=0.1),
        moving_obstacles=MovingObstacles(count=2, radius=0.2, speed=0.2),
    )
    moving = env.task.scene.moving
    assert moving.goal is not None and moving.goal.drift.direction == math.pi
    assert moving.goal.drift.speed == 0.1
    assert [each.name for each in moving.obstacles] == ["moving_box", "moving_0", "moving_1"]
    assert [each.home is None for each in moving.obstacles] == [False, True, True]
    assert [each.drift.speed for each in moving.obstacles] == pytest.approx([0.305, 0.2, 0.2])
    assert [each.radius for each in moving.obstacles] == pytest.approx([0.5, 0.2, 0.2])
    env.close()


@pytest.mark.parametrize("post", ["", '<geom name="obstacle_0" size="0.5" pos="0 2 0"/>'])
def test_a_room_without_walls_has_movers_too(tmp_path: Path, post: str) -> None:
    sites = '<site name="goal" pos="3 3 0"/><site name="start_0" pos="-3 -3 0"/>'
    (tmp_path / "open.xml").write_text(f"<mujoco><worldbody>{sites}{post}</worldbody></mujoco>")
    env = drive(
        tmp_path / "open.xml",
        moving_goal=MovingGoal(speed=3.0),
        moving_obstacles=MovingObstacles(count=2, speed=3.0),
    )
    movers = env.task.movers
    assert movers is not None
    for _ in range(2):
        env.reset()
        for _ in range(300):
            env.step(np.zeros(3))
            assert (
                np.abs([*movers.obstacles, movers.goal]).max() < 13.1
            )  # 10 m around what there is
    env.close()


def test_a_name_that_is_taken_is_no_trouble(own_room: OwnRoom) -> None:
    env = drive(own_room(body(name="moving_0")), moving_obstacles=MovingObstacles(count=2))
    names = [each.name for each in env.task.scene.moving.obstacles]
    assert names == ["moving_0", "moving_0_", "moving_1"]
    env.close()


def test_the_radius_holds_all_that_collides(own_room: OwnRoom) -> None:
    many = (
        '<geom type="cylinder" size="0.2 0.5" pos="0.1 0 0"/><geom type="sphere" size="0.2"/>'
        '<body pos="0 0.3 0"><geom type="capsule" fromto="0 0 0 0 0.4 0" size="0.1"/></body>'
        '<geom type="box" size="2 2 0.1" contype="0" conaffinity="0"/>'
    )
    (found,) = build_scene(own_room(body(many)), "nomad200").moving.obstacles
    assert found.radius == pytest.approx(0.8, abs=2e-3)
    (single,) = build_scene(own_room(body('<geom size="0.3"/>')), "nomad200").moving.obstacles
    assert single.radius == pytest.approx(0.3, abs=1e-12)


def test_what_is_not_asked_to_move_stands(own_room: OwnRoom) -> None:
    pole = body('<geom name="obstacle_pole" size="0.3"/>', name="pole")
    shadow = body('<geom size="0.3" contype="0" conaffinity="0"/>', name="moving_shadow")
    scene = build_scene(own_room(pole + shadow), "nomad200")
    assert not scene.moving and "obstacle_pole" in scene.plan.names


REFUSED: list[tuple[str, tuple[str, str], type[NomadError], str]] = [
    (body(more=""), ("", ""), ModelError, "'moving_box' cannot move: give it mocap=\"true\", or"),
    (
        body(more="").replace(BOX, "<freejoint/>" + BOX),
        ("", ""),
        ModelError,
        "room 'own': body 'moving_box' cannot move",
    ),
    (
        goal('<geom name="beacon" size="0.1"/>'),
        GOAL,
        ModelError,
        "'beacon' moves with the goal, so nothing may run into it: give it contype=\"0\"",
    ),
    (
        body().replace("1 -2", "4.9 -2"),
        ("", ""),
        StartError,
        "moving obstacle 'moving_box' of radius 0.5 m at (4.9, -2) is outside the room",
    ),
    (body().replace("1 -2", "3 2.5"), ("", ""), StartError, "nearer the goal than a robot"),
    (body().replace("1 -2", "30 2.5"), ("", ""), StartError, "at (30, 2.5) is outside the room"),
    (
        "",
        ('"goal"', '"flag"'),
        ModelError,
        "room 'own' has no site named 'goal'; sites there are: flag, start_0",
    ),
    (
        body() + body(name="moving_2"),
        ("", ""),
        StartError,
        "moving obstacle 'moving_2' of radius 0.5 m",
    ),
]


@pytest.mark.parametrize(("inside", "edit", "error", "message"), REFUSED)
def test_what_cannot_move_so_is_refused_in_one_line(
    own_room: OwnRoom, inside: str, edit: tuple[str, str], error: type[NomadError], message: str
) -> None:
    edits = (edit,) if edit[0] else ()
    for options in ({}, {"moving_goal": MovingGoal()}):
        with pytest.raises(error) as caught:
            drive(own_room(inside, *edits), **options)
        assert message in str(caught.value) and "\n" not in str(caught.value)


def test_the_room_that_comes_along_is_the_papers_with_figures_11_and_12() -> None:
    assert "moving_room" in list_rooms()
    moving = build_scene("moving_room", "nomad200").moving
    paper = build_scene(
        "paper_room", "nomad200", moving_goal=MovingGoal(), moving_obstacles=MovingObstacles()
    ).moving
    assert moving.goal is not None and paper.goal is not None
    assert abs(moving.goal.drift.direction) == pytest.approx(math.pi)
    assert len(moving.obstacles) == len(paper.obstacles) == 4
    for own, other in zip(moving.obstacles, paper.obstacles, strict=True):
        assert own.radius == pytest.approx(other.radius)
        assert own.drift.direction == pytest.approx(other.drift.direction)
        assert own.drift.speed == other.drift.speed == pytest.approx(0.305)
