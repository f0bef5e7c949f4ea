"""What is hidden from rays is out of their reach: they read the same."""

import copy

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj.arenas import Nearby

REACH = 3.0


def forest() -> mujoco.MjModel:
    """Return two hundred things of all kinds at random, one that moves and one on a body."""
    rng = np.random.default_rng(0)
    kinds = ("box", "cylinder", "capsule", "ellipsoid", "sphere", "mesh")
    geoms = []
    for number in range(200):
        x, y = rng.uniform(-10, 10, 2)
        a, b, c = rng.uniform(0.05, 0.6, 3)
        kind, angle = kinds[number % 6], rng.uniform(-180, 180, 3)
        look = 'material="m"' if number % 2 else 'rgba="1 0 0 0.5"'
        shape = 'mesh="tent"' if kind == "mesh" else f'size="{a} {b} {c}"'
        turn = "{} {} {}".format(*angle)
        geoms.append(f'<geom type="{kind}" {shape} pos="{x} {y} 0.4" euler="{turn}" {look}/>')
    vertices = "0 0 0  1 0 0  0 0.5 0  0 0 0.8"
    return mujoco.MjModel.from_xml_string(f"""<mujoco>
        <asset><mesh name="tent" vertex="{vertices}"/><material name="m" rgba="0 1 0 1"/></asset>
        <worldbody><geom type="plane" size="0 0 1"/>{"".join(geoms)}
        <body pos="1 2 0" euler="0 0 40"><geom name="shelf" size="0.5" pos="4 0 0.5"/></body>
        <body mocap="true"><geom name="walker" size="0.2" pos="9 9 0.5"/></body>
        <body><freejoint/><geom name="ball" size="0.2" pos="-9 9 0.5"/></body>
        </worldbody></mujoco>""")


FOREST = forest()
DATA = mujoco.MjData(FOREST)
mujoco.mj_forward(FOREST, DATA)
places = st.tuples(st.floats(-11, 11), st.floats(-11, 11))


def cast(model: mujoco.MjModel, x: float, y: float) -> np.ndarray:
    read: list[float] = []
    for angle in np.linspace(0, 6.28, 60):
        way = np.array([np.cos(angle), np.sin(angle), -0.05])
        start = np.array([x, y, 0.5])
        read.append(mujoco.mj_ray(model, DATA, start, way / np.linalg.norm(way), None, 1, -1, None))
    found = np.array(read)
    return np.where((found < 0) | (found > REACH), np.inf, found)


@settings(deadline=None, max_examples=60)
@given(st.lists(places, min_size=1, max_size=4), st.floats(0, 0.5), st.floats(0, 6.28))
def test_rays_read_the_same_wherever_the_robot_has_come_from(
    way: list[tuple[float, float]], moved: float, course: float
) -> None:
    seen = copy.copy(FOREST)
    nearby = Nearby(seen, REACH)
    for x, y in way:
        nearby.update(x, y)
    x, y = way[-1][0] + moved * np.cos(course), way[-1][1] + moved * np.sin(course)
    nearby.update(x, y)
    assert len(nearby.hidden) > 50
    np.testing.assert_array_equal(cast(seen, x, y), cast(FOREST, x, y))
    nearby.show_all()
    np.testing.assert_array_equal(seen.geom_rgba, FOREST.geom_rgba)
    np.testing.assert_array_equal(seen.geom_matid, FOREST.geom_matid)


def test_what_moves_and_the_floor_stay_visible() -> None:
    seen = copy.copy(FOREST)
    nearby = Nearby(seen, REACH)
    nearby.update(-100.0, 0.0)
    visible = {*range(seen.ngeom)} - {*nearby.hidden.tolist()}
    assert visible == {0, seen.geom("walker").id, seen.geom("ball").id}
    assert seen.geom("shelf").id in nearby.hidden


def test_a_small_turn_changes_nothing_and_a_jump_does() -> None:
    nearby = Nearby(copy.copy(FOREST), REACH)
    nearby.update(0.0, 0.0)
    before = nearby.hidden
    nearby.update(0.3, 0.1)
    assert nearby.hidden is before
    nearby.update(5.0, 5.0)
    assert {*nearby.hidden.tolist()} != {*before.tolist()}


@pytest.mark.parametrize("reach", [np.inf, 1e9])
def test_nothing_is_hidden_from_rays_that_reach_everything(reach: float) -> None:
    nearby = Nearby(copy.copy(FOREST), reach)
    nearby.update(0.0, 0.0)
    assert not len(nearby.hidden)


def test_small_rooms_are_left_alone() -> None:
    text = "".join(f'<geom size="0.1" pos="{100 * i} 0 0"/>' for i in range(20))
    nearby = Nearby(
        mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{text}</worldbody></mujoco>"), 1
    )
    nearby.update(0.0, 0.0)
    assert not len(nearby.hidden)
