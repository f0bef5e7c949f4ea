"""The rooms that come with the package, and the scene they stand in."""

import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.stats import qmc

from nomad_mj.arenas import Arena, FloorPlan, Geodesic, check_arena
from nomad_mj.arenas.halton import halton_starts
from nomad_mj.assets import list_rooms, models_dir
from nomad_mj.types import FloatArray

RADIUS, HEIGHT, CLEARANCE = 0.265, 0.9, 0.12
ROOMS = (
    "clutter",
    "concave_room",
    "concave_room_deep",
    "corridor",
    "empty_room",
    "hall",
    "moving_room",
    "paper_room",
)
SPEC_BOXES = {
    "paper_room": [[3.4, 4.4, 6.2, 5.6], [1.6, 6.8, 3.2, 8.2], [7, 2, 8.6, 3.4]],
    "concave_room": [[3.6, 5.2, 4, 6.4], [6, 5.2, 6.4, 6.4], [3.6, 6, 6.4, 6.4]],
    "concave_room_deep": [[3.6, 4.2, 4, 6.4], [6, 4.2, 6.4, 6.4], [3.6, 6, 6.4, 6.4]],
    "empty_room": [],
    "moving_room": [[3.4, 4.4, 6.2, 5.6], [1.6, 6.8, 3.2, 8.2], [7, 2, 8.6, 3.4]],
}


def load(room: str) -> tuple[mujoco.MjModel, Arena, FloorPlan]:
    model = mujoco.MjModel.from_xml_path(str(list_rooms()[room]))
    return model, Arena.from_model(model, room), FloorPlan.from_model(model, HEIGHT)


def test_all_rooms_are_here() -> None:
    assert tuple(list_rooms()) == ROOMS


@pytest.mark.parametrize("room", SPEC_BOXES)
def test_obstacles_stand_where_the_specification_puts_them(room: str) -> None:
    _, _, plan = load(room)
    obstacles = zip(plan.names, plan.footprints, strict=True)
    boxes = [shape.bounds for name, shape in obstacles if name.startswith("obstacle_")]
    expected = np.array(SPEC_BOXES[room]).reshape(-1, 4)
    np.testing.assert_allclose(np.reshape(boxes, (-1, 4)), expected, atol=1e-9)


@pytest.mark.parametrize("room", ROOMS)
def test_walls_enclose_the_room(room: str) -> None:
    _, arena, plan = load(room)
    np.testing.assert_allclose(plan.free_space(0.0, arena.goal).bounds, (0, 0, 10, 10), atol=1e-9)
    assert np.all(np.abs(plan.bounds - [0, 0, 10, 10]) <= 0.2)


@pytest.mark.parametrize("room", ROOMS)
def test_geoms_are_named_and_higher_than_the_sonars(room: str) -> None:
    model, _, plan = load(room)
    moving = model.body_mocapid[model.geom_bodyid] >= 0
    assert len(plan.names) == model.ngeom - moving.sum()
    names = [model.geom(i).name for i in range(model.ngeom)]
    assert all(name.startswith(("wall_", "obstacle_")) for name in names)
    tops = model.geom_pos[:, 2] + model.geom_size[:, :].max(axis=1, where=[[0, 0, 1]], initial=0)
    cylinders = model.geom_type == mujoco.mjtGeom.mjGEOM_CYLINDER
    tops[cylinders] = (model.geom_pos[:, 2] + model.geom_size[:, 1])[cylinders]
    tops += model.body_pos[model.geom_bodyid, 2]
    assert tops.min() >= 0.9


@pytest.mark.parametrize("room", ROOMS)
def test_the_scene_alone_owns_light_and_options(room: str) -> None:
    spec = mujoco.MjSpec.from_file(str(list_rooms()[room]))
    assert not list(spec.lights)
    assert all(geom.type != mujoco.mjtGeom.mjGEOM_PLANE for geom in spec.geoms)
    assert spec.option.timestep == mujoco.MjSpec().option.timestep


@pytest.mark.parametrize("room", ROOMS)
def test_a_robot_goes_from_every_start_to_the_goal_with_room_to_spare(room: str) -> None:
    _, arena, plan = load(room)
    assert len(arena.starts) == 50
    check_arena(plan, arena, RADIUS + CLEARANCE)
    assert np.isfinite(Geodesic(plan, arena.goal, RADIUS).length(arena.starts[:, :2])).all()


@pytest.mark.parametrize("room", ROOMS)
def test_starts_follow_the_halton_rule(room: str) -> None:
    _, arena, plan = load(room)
    first = 1 if room.startswith("concave") else 0  # start_00 lies in the U
    expected = halton_starts(plan, 50 - first, arena.goal)
    np.testing.assert_allclose(arena.starts[first:, :2], expected, atol=1e-4)
    assert arena.start_names == tuple(f"start_{i:02d}" for i in range(50))


def test_starts_of_the_paper_room_written_out() -> None:
    """The rule again, with nothing of the library's: distances to rectangles by hand."""
    _, arena, _ = load("paper_room")
    goal = np.array([7.4, 8.6])
    np.testing.assert_allclose(arena.goal, goal, atol=1e-9)
    points = 10 * qmc.Halton(2, scramble=False).random(200)
    clearance = np.minimum(points, 10 - points).min(axis=1)
    for x0, y0, x1, y1 in SPEC_BOXES["paper_room"]:
        outside = np.maximum(np.array([x0, y0]) - points, points - np.array([x1, y1]))
        clearance = np.minimum(clearance, np.linalg.norm(outside.clip(min=0), axis=1))
    good = (clearance - RADIUS > CLEARANCE) & (np.linalg.norm(points - goal, axis=1) >= 1.2)
    np.testing.assert_allclose(arena.starts[:, :2], points[good][:50], atol=1e-4)


@pytest.mark.parametrize("room", ["concave_room", "concave_room_deep"])
def test_the_first_start_lies_inside_the_u(room: str) -> None:
    _, arena, plan = load(room)
    x, y, _ = arena.starts[0]
    assert 4.0 + RADIUS < x < 6.0 - RADIUS
    assert 5.2 < y < 6.0 - RADIUS
    straight = float(np.linalg.norm(arena.goal - [x, y]))
    assert Geodesic(plan, arena.goal, RADIUS).length([x, y]) > 1.7 * straight


def test_the_passages_of_the_corridor_are_wide() -> None:
    _, arena, plan = load("corridor")
    lanes = [[0.9, 0.9], [9.0, 1.2], [1.0, 3.7], [7.5, 3.7], [1.0, 6.3], [9.0, 6.0], [9.0, 8.8]]
    assert plan.reaches(lanes, arena.goal, 0.6).all()
    assert Geodesic(plan, arena.goal, RADIUS).length([0.9, 0.9]) > 30


@pytest.mark.parametrize("room", ROOMS)
@pytest.mark.parametrize("camera", ["top", "overview"])
def test_cameras_see_the_whole_room(room: str, camera: str) -> None:
    model, arena, _ = load(room)
    assert arena.cameras == ("top", "overview")
    corners = np.array([[x, y, z] for x in (0, 10) for y in (0, 10) for z in (0, 0.9)], dtype=float)
    x, y = project(model, camera, corners)
    assert np.abs(y).max() < 1
    assert np.abs(x).max() < 4 / 3


def project(
    model: mujoco.MjModel, camera: str, points: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Place in the picture, in half heights of it from its centre."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    view = data.camera(camera)
    seen = (points - view.xpos) @ view.xmat.reshape(3, 3)
    fovy = float(model.camera(camera).fovy[0])
    if model.cam_projection[model.camera(camera).id] == mujoco.mjtProjection.mjPROJ_ORTHOGRAPHIC:
        half_height = np.full(len(points), fovy / 2)
    else:
        half_height = -seen[:, 2] * np.tan(np.radians(fovy) / 2)
    return seen[:, 0] / half_height, seen[:, 1] / half_height


def test_scene_settings() -> None:
    model = mujoco.MjModel.from_xml_path(str(models_dir() / "scene.xml"))
    assert model.opt.timestep == 0.005
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    assert model.opt.cone == mujoco.mjtCone.mjCONE_PYRAMIDAL
    assert (model.vis.global_.offwidth, model.vis.global_.offheight) == (1920, 1080)
    assert not model.light_castshadow.any()


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_attaches_to_the_scene(room: str) -> None:
    spec = mujoco.MjSpec.from_file(str(models_dir() / "scene.xml"))
    arena = mujoco.MjSpec.from_file(str(list_rooms()[room]))
    spec.attach(arena, prefix="room/", frame=spec.worldbody.add_frame())
    model = spec.compile()
    _, alone, plan = load(room)
    attached = Arena.from_model(model, room)
    np.testing.assert_allclose(attached.starts, alone.starts)
    assert attached.start_names == alone.start_names
    assert FloorPlan.from_model(model, HEIGHT).names == plan.names


def test_the_smallest_room_of_the_readme_is_enough() -> None:
    text = Path(models_dir() / "arenas" / "README.md").read_text(encoding="utf-8")
    (snippet,) = re.findall(r"```xml\n(.*?)```", text, flags=re.DOTALL)
    model = mujoco.MjModel.from_xml_string(snippet)
    arena = Arena.from_model(model, "my_room")
    check_arena(FloorPlan.from_model(model, HEIGHT), arena, RADIUS + CLEARANCE)
    np.testing.assert_allclose(arena.starts, [[1, 1, np.pi / 2]])
    assert arena.cameras == ("top", "overview")


def test_the_readme_lists_every_room() -> None:
    text = Path(models_dir() / "arenas" / "README.md").read_text(encoding="utf-8")
    assert all(f"| `{room}` |" in text for room in ROOMS)
