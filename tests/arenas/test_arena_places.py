import dataclasses

import mujoco
import numpy as np
import pytest
import shapely

from nomad_mj.arenas import Arena, FloorPlan, check_arena
from nomad_mj.errors import ModelError, StartError

PLAN = FloorPlan([("wall_1", shapely.box(2, -9, 2.1, 9)), ("pole", shapely.box(5, 5, 5.1, 5.1))])
ROOM = '<site name="start_b" pos="1 2 0"/><site name="goal" pos="1 4 0.5"/>'


def arena(body: str) -> Arena:
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    return Arena.from_model(model, "x")


def test_reads_places_in_the_order_of_the_file() -> None:
    room = arena(
        f"""
        {ROOM}
        <frame pos="0 1 0" euler="0 0 90"><site name="start_a" pos="1 0 0" euler="0 0 -30"/></frame>
        <site name="decoration"/><site/>
        <camera name="top"/><camera/>
        <body name="robot/base"><site name="robot/start_me"/><camera name="robot/chase"/></body>
        """
    )
    assert room.name == "x"
    np.testing.assert_allclose(room.goal, [1, 4])
    assert room.start_names == ("start_b", "start_a")
    np.testing.assert_allclose(room.starts, [[1, 2, 0], [0, 2, np.pi / 3]], atol=1e-12)
    assert room.cameras == ("top",)


def test_names_are_those_of_the_room_file_also_after_attaching() -> None:
    room = mujoco.MjSpec.from_string(f"<mujoco><worldbody>{ROOM}</worldbody></mujoco>")
    scene = mujoco.MjSpec()
    scene.attach(room, prefix="room/", frame=scene.worldbody.add_frame())
    assert Arena.from_model(scene.compile(), "x").start_names == ("start_b",)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("", "room 'x' has no site named 'goal'; sites there are: none"),
        (
            '<site name="start_0"/><site name="gaol"/>',
            "room 'x' has no site named 'goal'; sites there are: start_0, gaol",
        ),
        (
            '<site name="goal"/>',
            "room 'x' has no site whose name begins with 'start'; sites there are: goal",
        ),
    ],
)
def test_what_is_missing_is_said_in_one_line(body: str, message: str) -> None:
    with pytest.raises(ModelError) as error:
        arena(body)
    assert str(error.value) == message


def test_a_good_room_passes() -> None:
    check_arena(PLAN, arena(ROOM), 0.265)


@pytest.mark.parametrize(
    ("start", "goal", "radius", "message"),
    [
        ((1.8, 1), (1, 4), 0.265, r"at site 'start_b' \(1.80, 1.00\) overlaps 'wall_1' by 0.065 m"),
        ((1, 1), (5.05, 5.05), 0.265, r"at site 'goal' \(5.05, 5.05\) overlaps 'pole' by 0.315 m"),
        ((1, 1), (4, 4), 5.0, "overlaps"),
    ],
)
def test_a_place_in_an_obstacle_is_refused(
    start: tuple[float, float], goal: tuple[float, float], radius: float, message: str
) -> None:
    bad = dataclasses.replace(
        arena(ROOM), goal=np.array(goal), starts=np.array([[*start, 0.0]]), start_names=("start_b",)
    )
    with pytest.raises(StartError, match=message) as error:
        check_arena(PLAN, bad, radius)
    assert "\n" not in str(error.value)


def test_a_goal_behind_a_closed_wall_is_refused() -> None:
    ring = shapely.box(-9, -9, 9, 9) - shapely.box(-8.9, -8.9, 8.9, 8.9)
    plan = FloorPlan([("ring", ring), ("wall", shapely.box(-9, 3, 9, 3.1))])
    with pytest.raises(StartError, match=r"the goal \(1.00, 4.00\) from site 'start_b'"):
        check_arena(plan, arena(ROOM), 0.265)
