"""The cameras of a made room see all of it, as large as they can."""

import math

import mujoco
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj.rooms import Box, Cylinder, Polygon, Room, to_mjcf
from nomad_mj.rooms.plan_file import walls_along
from nomad_mj.types import FloatArray

sides = st.floats(1, 60)


def project(model: mujoco.MjModel, camera: str, points: FloatArray) -> FloatArray:
    """Return places in the picture (N, 2), in half heights of it from its centre."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    view = data.camera(camera)
    seen = (points - view.xpos) @ view.xmat.reshape(3, 3)
    assert (seen[:, 2] < 0).all()  # before the camera
    fovy = float(model.camera(camera).fovy[0])
    if camera == "top":
        return seen[:, :2] / (fovy / 2)
    return seen[:, :2] / (-seen[:, 2:] * math.tan(math.radians(fovy) / 2))


@settings(deadline=None, max_examples=40)
@given(sides, sides, st.floats(-50, 50), st.floats(0.9, 3), st.floats(0, math.pi))
def test_rooms_of_all_sizes_and_shapes_are_seen_whole(
    length: float, width: float, x: float, height: float, angle: float
) -> None:
    outline = ((x, 0.0), (x + length, 0.0), (x + length, width), (x, width))
    tent = Polygon(((x, 0.1), (x + 0.5, 0.1), (x, 0.9)))
    things = (Cylinder(x + 0.5, 0.5, 0.2), Box(x + 0.5, 0.5, 0.8, 0.3, angle), tent)
    room = Room("r", walls_along(outline), things, (x, 0.0, x + length, width), height=height)
    model = mujoco.MjModel.from_xml_string(to_mjcf(room))
    low, high = np.array([x - 0.15, -0.15]), np.array([x + length + 0.15, width + 0.15])
    corners = np.array(
        [[a, b, c] for a in (low[0], high[0]) for b in (low[1], high[1]) for c in (0, height)]
    )
    for camera, wide in (("top", 1.0), ("overview", 4 / 3)):
        across, up = np.abs(project(model, camera, corners)).max(axis=0)
        assert across < wide and up < 1
        assert across > 0.9 * wide or up > 0.9


def test_walls_thicker_than_the_floor_is_wide_are_seen() -> None:
    walls = (Box(-3.0, 0.0, 5.0, 2.0), Box(3.0, 0.0, 5.0, 2.0, 0.4))
    model = mujoco.MjModel.from_xml_string(to_mjcf(Room("r", walls, (), (-0.5, -1, 0.5, 1))))
    for camera in ("top", "overview"):
        (left,) = project(model, camera, np.array([[-5.5, 1.0, 0.0]]))
        assert -4 / 3 < left[0] < -0.85


def test_a_room_too_large_for_an_orthographic_camera_has_the_other_one() -> None:
    outline = ((0.0, 0.0), (1000.0, 0.0), (1000.0, 900.0), (0.0, 900.0))
    room = Room("r", walls_along(outline), (), (0.0, 0.0, 1000.0, 900.0))
    model = mujoco.MjModel.from_xml_string(to_mjcf(room))
    assert model.ncam == 1
    corners = np.array([[x, y, 0.0] for x in (0, 1000) for y in (0, 900)])
    assert np.abs(project(model, "overview", corners)).max() <= 4 / 3
