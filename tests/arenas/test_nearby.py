"""What is left out is out of reach: rays read the same and the robot runs into the same things."""

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj.arenas import Nearby, near_model
from nomad_mj.arenas.standing import most_near, rectangles, standing

REACH = 3.0
BALL = '<body name="ball"><freejoint/><geom size="0.2" pos="-9 9 0.5"/></body>'


def forest(more: str = "", count: int = 200) -> mujoco.MjSpec:
    """Return things of all kinds at random, one on a body, and a robot that slides among them."""
    rng = np.random.default_rng(0)
    kinds = ("box", "cylinder", "capsule", "ellipsoid", "sphere", "mesh")
    geoms: list[str] = []
    for number in range(count):
        x, y = rng.uniform(-10, 10, 2)
        a, b, c = rng.uniform(0.05, 0.6, 3)
        kind, angle = kinds[number % 6], rng.uniform(-180, 180, 3)
        look = 'material="m"' if number % 2 else 'rgba="1 0 0 0.5"'
        shape = 'mesh="tent"' if kind == "mesh" else f'size="{a} {b} {c}"'
        turn, touch = "{} {} {}".format(*angle), f'margin="{0.1 * (number % 5 == 0)}"'
        where = f'name="thing_{number}" pos="{x} {y} 0.4" euler="{turn}"'
        geoms.append(f'<geom type="{kind}" {shape} {where} {look} {touch}/>')
    vertices = "0 0 0  1 0 0  0 0.5 0  0 0 0.8"
    return mujoco.MjSpec.from_string(f"""<mujoco>
        <asset><mesh name="tent" vertex="{vertices}"/><material name="m" rgba="0 1 0 1"/></asset>
        <worldbody><geom name="floor" type="plane" size="0 0 1"/>{"".join(geoms)}
        <body name="hung" pos="1 2 0" euler="0 10 40">
        <geom name="shelf" type="box" size="0.5 0.4 0.3" pos="4 0 0.5" euler="0 0 20"/></body>
        <body name="walker" mocap="true"><geom name="walker" size="0.2" pos="9 9 0.5"/></body>
        <body name="robot" pos="0 0 0.5">
        <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>
        <geom name="shell" type="cylinder" size="0.3 0.3"/></body>
        </worldbody>{more}</mujoco>""")


def pair() -> tuple[mujoco.MjModel, mujoco.MjModel]:
    spec = forest()
    whole = spec.compile()
    few = near_model(spec, whole, REACH)
    assert few is not None
    return whole, few


WHOLE, FEW = pair()
places = st.tuples(st.floats(-11, 11), st.floats(-11, 11))


def put(model: mujoco.MjModel, x: float, y: float) -> mujoco.MjData:
    data = mujoco.MjData(model)
    data.qpos[:] = x, y
    mujoco.mj_step1(model, data)
    return data


def cast(model: mujoco.MjModel, x: float, y: float) -> np.ndarray:
    """Return what rays read from there, infinite beyond their reach."""
    data, body, read = put(model, x, y), model.body("robot").id, list[float]()
    for angle in np.linspace(0, 6.28, 60):
        way = np.array([np.cos(angle), np.sin(angle), -0.05])
        start = np.array([x, y, 0.5])
        way /= np.linalg.norm(way)
        read.append(mujoco.mj_ray(model, data, start, way, None, 1, body, None))
    found = np.array(read)
    return np.where((found < 0) | (found > REACH), np.inf, found)


def contacts(model: mujoco.MjModel, x: float, y: float) -> list[np.ndarray]:
    """Return all about what the robot touches, in the order of depth: the engine's may differ."""
    touched = put(model, x, y).contact
    order = np.lexsort((touched.pos[:, 2], touched.dist))
    values = (touched.dist, touched.pos, touched.frame, touched.friction, touched.solref)
    return [value[order] for value in values]


@settings(deadline=None, max_examples=50)
@given(st.lists(places, min_size=1, max_size=4), st.floats(0, 0.5), st.floats(0, 6.28))
def test_all_is_the_same_wherever_the_robot_has_come_from(
    way: list[tuple[float, float]], moved: float, course: float
) -> None:
    nearby = Nearby(WHOLE, FEW, REACH)
    for x, y in way:
        nearby.update(x, y)
    x, y = way[-1][0] + moved * np.cos(course), way[-1][1] + moved * np.sin(course)
    nearby.update(x, y)
    np.testing.assert_array_equal(cast(FEW, x, y), cast(WHOLE, x, y))
    for few, all_there_is in zip(contacts(FEW, x, y), contacts(WHOLE, x, y), strict=True):
        np.testing.assert_array_equal(few, all_there_is)


def test_the_robot_runs_into_each_of_the_things() -> None:
    nearby, struck = Nearby(WHOLE, FEW, REACH), set[int]()
    slots = {FEW.geom(f"near/{slot}").id: slot for slot in range(FEW.ngeom - 3)}
    for geom in standing(WHOLE).tolist():
        x, y = rectangles(WHOLE, np.array([geom]))[0][0]
        nearby.update(x, y)
        for one in put(FEW, x, y).contact.geom:
            struck |= {int(nearby.held[slots[int(g)]]) for g in one if int(g) in slots}
    assert len(struck) > 190 and WHOLE.geom("shelf").id in struck


def test_what_moves_and_the_floor_stay_and_far_away_nothing_else_does() -> None:
    nearby = Nearby(WHOLE, FEW, REACH)
    nearby.update(-100.0, 0.0)
    assert not len(nearby.held)
    seen = {FEW.geom(geom).name for geom in np.flatnonzero(FEW.geom_rgba[:, 3])}
    assert seen == {"floor", "walker", "shell"}
    assert FEW.ngeom < 90  # of 204


def test_a_small_move_changes_nothing_and_a_jump_does() -> None:
    nearby = Nearby(WHOLE, FEW, REACH)
    nearby.update(0.0, 0.0)
    before = nearby.held
    nearby.update(0.3, 0.1)
    assert nearby.held is before
    nearby.update(5.0, 5.0)
    assert {*nearby.held.tolist()} != {*before.tolist()}


@settings(deadline=None, max_examples=40)
@given(
    st.lists(st.tuples(places, places), min_size=1, max_size=30),
    st.floats(0.1, 8),
    st.lists(places, min_size=20, max_size=20),
    st.floats(0.1, 100),
)
def test_nowhere_is_more_near_than_there_are_slots(
    boxes: list[tuple[tuple[float, float], tuple[float, float]]],
    reach: float,
    at: list[tuple[float, float]],
    scale: float,
) -> None:
    middle, half = scale * np.array(boxes).transpose(1, 0, 2)
    half = np.abs(half) / 10
    slots = most_near(middle, half, reach)
    assert slots <= len(boxes)
    for place in (*(1.5 * scale * np.array(at)), *middle, *(middle + half)):
        gap = np.maximum(np.abs(middle - place) - half, 0.0)
        assert np.count_nonzero(np.hypot(*gap.T) <= reach) <= slots


def test_of_things_far_apart_one_is_near_at_once() -> None:
    middle = np.stack([np.arange(0.0, 500.0, 50.0), np.zeros(10)], axis=1)
    assert most_near(middle, np.full((10, 2), 0.5), 10.0) == 1


@pytest.mark.parametrize(
    "named",
    [
        '<contact><pair geom1="shell" geom2="thing_7"/></contact>',
        '<sensor><distance geom1="shell" geom2="thing_7" cutoff="9"/></sensor>',
        '<custom><tuple name="t"><element objtype="geom" objname="thing_7"/></tuple></custom>',
    ],
)
def test_what_something_names_stays(named: str) -> None:
    spec = forest(named)
    whole = spec.compile()
    few = near_model(spec, whole, REACH)
    assert few is not None
    np.testing.assert_array_equal(few.geom("thing_7").pos, whole.geom("thing_7").pos)
    assert whole.geom("thing_7").id not in standing(whole)
    assert whole.geom("shelf").id in standing(whole)


@pytest.mark.parametrize(
    "named",
    [
        '<sensor><distance body1="robot" body2="hung" cutoff="9"/></sensor>',
        '<contact><exclude body1="robot" body2="hung"/></contact>',
    ],
)
def test_what_is_on_a_body_that_something_names_stays(named: str) -> None:
    whole = forest(named).compile()
    assert whole.geom("shelf").id not in standing(whole)
    assert whole.geom("thing_7").id in standing(whole)


@pytest.mark.parametrize("reach", [np.inf, 1e9])
def test_rays_that_reach_everything_need_all_there_is(reach: float) -> None:
    spec = forest()
    assert near_model(spec, spec.compile(), reach) is None


def test_small_rooms_are_left_alone() -> None:
    spec = forest(count=55)
    assert near_model(spec, spec.compile(), 0.1) is None


def test_what_else_may_fall_somewhere_needs_all_there_is() -> None:
    spec = forest(f"<worldbody>{BALL}</worldbody>")
    assert near_model(spec, spec.compile(), REACH) is None
