"""Rooms by plan and by seed: the same again, and always solvable."""

from pathlib import Path

import mujoco
import numpy as np
import pytest
import shapely

import nomad_mj
from nomad_mj.arenas.halton import RADIUS
from nomad_mj.errors import ConfigError, NomadError
from nomad_mj.rooms import (
    Box,
    Cylinder,
    Polygon,
    concave_room,
    convex_room,
    furnish,
    maze_room,
    random_room,
    read_room,
    to_mjcf,
    wide_room,
)
from nomad_mj.rooms.places import floor_plan

PLAN = """
outline: [[0, 0], [6, 0], [6, 4], [3, 4], [3, 6], [0, 6]]
obstacles:
  - box: [3, 1.5, 0.8, 0.3]
    angle: 30
  - cylinder: [1, 3, 0.3]
  - polygon: [[4.5, 3], [5, 3], [4.7, 3.5]]
"""
MAKERS = {
    "random": random_room,
    "convex": convex_room,
    "wide": wide_room,
    "concave": concave_room,
    "maze": maze_room,
}


@pytest.mark.parametrize("kind", MAKERS)
@pytest.mark.parametrize("difficulty", [0.0, 1.0])
def test_rooms_made_up_can_be_solved_from_everywhere(kind: str, difficulty: float) -> None:
    for seed in range(3):
        room = furnish(MAKERS[kind](seed, difficulty))
        assert to_mjcf(room) == to_mjcf(furnish(MAKERS[kind](seed, difficulty)))
        assert len(room.starts) == 20 and room.goal
        plan = floor_plan(room)
        places = np.array(room.starts)[:, :2]
        assert plan.reaches(places, room.goal, RADIUS).all()
        assert (plan.clearance(places, RADIUS) > 0.1).all()
    assert to_mjcf(MAKERS[kind](1, difficulty)) != to_mjcf(MAKERS[kind](2, difficulty))


@pytest.mark.parametrize("kind", ["convex", "wide", "concave"])
@pytest.mark.parametrize("difficulty", [0.0, 0.5, 1.0])
def test_the_robot_can_go_around_what_keeps_apart(kind: str, difficulty: float) -> None:
    parts = 3 if kind == "concave" else 1  # of an obstacle
    for seed in range(5):
        room = MAKERS[kind](seed, difficulty)
        shapes = floor_plan(room).footprints[len(room.walls) :]
        things = [shapely.union_all(shapes[n : n + parts]) for n in range(0, len(shapes), parts)]
        assert len(things) >= 2
        for number, thing in enumerate(things):
            assert shapely.box(0, 0, 10, 10).exterior.distance(thing) > 2 * RADIUS
            others = shapely.union_all([*things[:number], *things[number + 1 :]])
            assert thing.distance(others) > 2 * RADIUS
            assert (kind == "concave") == (thing.convex_hull.area > 1.05 * thing.area)


def test_walls_of_a_wide_room_are_wider_than_what_the_robot_sees() -> None:
    for seed in range(10):
        boxes = wide_room(seed).obstacles
        assert boxes and all(isinstance(box, Box) and box.length >= 3 for box in boxes)


def test_difficulty_adds_obstacles() -> None:
    counts = [len(random_room(7, difficulty).obstacles) for difficulty in (0.0, 0.5, 1.0)]
    assert counts == sorted(counts) and counts[0] == 4 and counts[2] >= 15


@pytest.mark.parametrize("kind", MAKERS)
@pytest.mark.parametrize(("seed", "difficulty"), [(-1, 0.5), (2, 1.5), (2, float("nan"))])
def test_seeds_and_difficulties_that_make_no_sense(kind: str, seed: int, difficulty: float) -> None:
    with pytest.raises(ConfigError):
        MAKERS[kind](seed, difficulty)


def test_a_plan_is_read_as_it_is_written(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(PLAN + "goal: [5, 1]\nstarts: [[1, 1], [1, 5, -90]]\n")
    room = read_room(tmp_path / "plan.yaml")
    assert [type(shape) for shape in room.obstacles] == [Box, Cylinder, Polygon]
    assert room.goal == (5, 1) and room.starts[1] == (1, 5, -np.pi / 2)
    path = tmp_path / "room.xml"
    path.write_text(to_mjcf(room))
    mujoco.MjModel.from_xml_path(str(path))
    with nomad_mj.load("motor", room=path, task_kwargs={"random": 0}) as env:
        scene = env.task.scene
        assert np.allclose(scene.arena.starts[:, :2], [[1, 1], [1, 5]])
        assert np.allclose(scene.plan.free_space(0.0, (5, 1)).bounds, (0, 0, 6, 6))
        env.reset()
        env.step([0.3, 0.0, 0.0])


def test_what_a_plan_leaves_out_is_chosen(tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(PLAN)
    room = read_room(tmp_path / "plan.yaml")
    assert room.goal and len(room.starts) == 20
    assert floor_plan(room).clearance(room.goal, RADIUS) > 0.5
    assert room == read_room(tmp_path / "plan.yaml")


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "must hold keys and values"),
        ("size: [4, 4", "is not valid YAML"),
        ("size: [.nan, 4]", "size nan: must be a number"),
        ("size: [4]", "must be a list of 2 numbers"),
        ("obstacles: []", "must have either size"),
        ("size: [4, 4]\nwals: 3", "knows no 'wals'"),
        ("size: [4, 4]\nobstacles: 3", "must be a list"),
        ("size: [4, 4]\nobstacles: [ball]", "obstacle 1: must be one of: box, cylinder, polygon"),
        ("size: [4, 4]\nobstacles: [{box: [1, 1, -1, 1]}]", "size -1.0: must be a number"),
        ("size: [4, 4]\nobstacles: [{polygon: [[0, 0], [2, 0], [1.2, 0.8], [2, 2]]}]", "convex"),
        ("outline: [[0, 0], [4, 4], [4, 0], [0, 4]]", "its edges cross"),
        ("size: [4, 4]\ngoal: [9, 9]\nstarts: [[1, 1]]", "goal (9, 9) is outside"),
        ("size: [4, 4]\nobstacles: [{box: [2, 2, 4, 4]}]", "fits nowhere"),
        ("size: [1.5, 1.5]", "has only 0 of 1 starts"),
        ("a: &a [*a]", "*a stands for something else; write that out"),
    ],
)
def test_mistakes_in_a_plan_are_told_in_one_line(text: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_text(text)
    with pytest.raises(NomadError) as raised:
        read_room(tmp_path / "plan.yaml")
    assert told in str(raised.value) and "\n" not in str(raised.value)
