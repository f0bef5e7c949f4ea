import mujoco
import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj.arenas import FloorPlan
from nomad_mj.arenas.footprints import footprints
from nomad_mj.errors import ModelError
from nomad_mj.types import FloatArray

TOLERANCE = 0.002


def compile_room(body: str, asset: str = "") -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(
        f"<mujoco><asset>{asset}</asset><worldbody>{body}</worldbody></mujoco>"
    )


def surface(kind: str, size: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Points on a primitive's surface, in its own frame, without using the library."""
    way = rng.normal(size=(4000, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    if kind == "box":
        return rng.choice([-1.0, 1.0], size=(4000, 3)) * size
    if kind == "sphere":
        return way * size[0]
    if kind == "ellipsoid":
        return way * size
    ends = np.sign(way[:, 2:]) * np.array([0, 0, size[1]])
    if kind == "capsule":
        return way * size[0] + ends
    rim = way[:, :2] / np.linalg.norm(way[:, :2], axis=1, keepdims=True)
    return np.concatenate([rim * size[0], ends[:, 2:]], axis=1)


@settings(deadline=None, max_examples=60)
@given(
    st.sampled_from(["box", "sphere", "ellipsoid", "capsule", "cylinder"]),
    st.lists(st.floats(0.05, 1.5), min_size=3, max_size=3),
    st.lists(st.floats(-180, 180), min_size=3, max_size=3),
    st.integers(0, 1000),
)
def test_a_footprint_holds_the_shape_and_hardly_more(
    kind: str, size: list[float], euler: list[float], seed: int
) -> None:
    angles = " ".join(f"{angle:.6f}" for angle in euler)
    model = compile_room(
        f'<geom name="g" type="{kind}" size="{size[0]} {size[1]} {size[2]}" euler="{angles}"'
        ' pos="1 2 0.4"/>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    local = surface(kind, np.array(size), np.random.default_rng(seed))
    world = local @ data.geom("g").xmat.reshape(3, 3).T + data.geom("g").xpos
    ((name, footprint),) = footprints(model, 0.9, "robot/")
    assert name == "g"
    assert shapely.distance(shapely.points(world[:, :2]), footprint).max() < 1e-9
    drawn = shapely.MultiPoint(world[:, :2]).convex_hull
    gap = 1e-9 if kind == "box" else TOLERANCE + 0.03 * max(size)  # the sample's own coarseness
    assert shapely.hausdorff_distance(drawn, footprint) < gap


@pytest.mark.parametrize("radius", [0.05, 0.3, 2.0, 5.0])
def test_round_things_are_drawn_within_two_millimetres(radius: float) -> None:
    model = compile_room(f'<geom type="cylinder" size="{radius} 0.5"/>')
    ((_, footprint),) = footprints(model, 0.9, "robot/")
    corners = np.linalg.norm(shapely.get_coordinates(footprint), axis=1)
    assert radius < corners.max() < radius + TOLERANCE
    assert shapely.boundary(footprint).distance(shapely.Point(0, 0)) >= radius - 1e-9


def test_a_mesh_counts_as_its_convex_hull() -> None:
    vertices = "0 0 0  2 0 0  0 2 0  2 2 0  1 0.5 0  0 0 1  2 0 1  0 2 1  2 2 1  1 0.5 1"
    model = compile_room(
        '<geom name="m" type="mesh" mesh="m" pos="3 1 0" euler="0 0 90"/>',
        f'<mesh name="m" vertex="{vertices}"/>',
    )
    ((_, footprint),) = footprints(model, 0.9, "robot/")
    np.testing.assert_allclose(footprint.bounds, [1, 1, 3, 3], atol=1e-6)
    assert footprint.area == pytest.approx(4, abs=1e-5)


def test_geoms_stand_where_their_bodies_put_them() -> None:
    model = compile_room(
        '<body pos="2 0 0" euler="0 0 90"><body pos="1 0 0"><joint type="slide" axis="1 0 0"/>'
        '<geom type="box" size="0.5 0.1 0.5"/></body></body>'
    )
    ((name, footprint),) = footprints(model, 0.9, "robot/")
    assert name == "geom 0"
    np.testing.assert_allclose(footprint.bounds, [1.9, 0.5, 2.1, 1.5], atol=1e-9)


def test_only_what_the_robot_can_hit_is_in_the_plan() -> None:
    model = compile_room(
        """
        <geom name="floor" type="plane" size="0 0 1"/>
        <geom name="rug" type="box" size="1 1 0.004" pos="0 0 0.004"/>
        <geom name="lamp" type="sphere" size="0.2" pos="0 0 1.2"/>
        <geom name="paint" type="box" size="1 1 1" contype="0" conaffinity="0"/>
        <geom name="half" type="box" size="1 1 1" contype="0"/>
        <geom name="low_lamp" type="sphere" size="0.2" pos="3 0 1.05"/>
        <body name="robot/base"><geom type="sphere" size="0.3"/>
          <body><geom type="sphere" size="0.3" pos="0 0 0.3"/></body></body>
        """
    )
    assert FloorPlan.from_model(model, 0.9).names == ("half", "low_lamp")
    assert "lamp" in FloorPlan.from_model(model, 1.1).names


@pytest.mark.parametrize(
    ("body", "asset", "words"),
    [
        ('<geom name="w" type="plane" size="1 1 1" euler="90 0 0"/>', "", "'w' is a plane"),
        (
            '<geom name="hills" type="hfield" hfield="h"/>',
            '<hfield name="h" nrow="2" ncol="2" size="1 1 1 1"/>',
            "'hills' is a hfield, which has no footprint",
        ),
    ],
)
def test_what_has_no_footprint_is_refused(body: str, asset: str, words: str) -> None:
    with pytest.raises(ModelError, match=words) as error:
        FloorPlan.from_model(compile_room(body, asset), 0.9)
    assert "\n" not in str(error.value)
