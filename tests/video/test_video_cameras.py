import math
from pathlib import Path

import mujoco
import numpy as np
import pytest

from nomad_mj.scene import Scene, build_scene
from nomad_mj.video.cameras import ChaseCamera, fixed_camera
from nomad_mj.video.canvas import sees_sky

ROOM = """
<mujoco><worldbody>
  <geom name="wall_south" type="box" pos="3 -0.1 0.45" size="3.2 0.1 0.45"/>
  <geom name="wall_north" type="box" pos="3 4.1 0.45" size="3.2 0.1 0.45"/>
  <geom name="wall_west" type="box" pos="-0.1 2 0.45" size="0.1 2 0.45"/>
  <geom name="wall_east" type="box" pos="6.1 2 0.45" size="0.1 2 0.45"/>
  <site name="goal" pos="5 3 0"/>
  <site name="start" pos="0.5 2 0"/>
</worldbody></mujoco>
"""


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Scene:
    """A room without cameras."""
    path: Path = tmp_path_factory.mktemp("rooms") / "bare.xml"
    path.write_text(ROOM)
    return build_scene(path, "nomad200")


def place(scene: Scene, x: float, y: float) -> mujoco.MjData:
    data = mujoco.MjData(scene.model)
    data.qpos[scene.model.joint("robot/base_x").qposadr[0]] = x
    data.qpos[scene.model.joint("robot/base_y").qposadr[0]] = y
    mujoco.mj_forward(scene.model, data)
    return data


def look(
    scene: Scene, data: mujoco.MjData, camera: mujoco.MjvCamera, drawn: mujoco.MjvScene
) -> None:
    every = mujoco.mjtCatBit.mjCAT_ALL.value
    option = mujoco.MjvOption()
    mujoco.mjv_updateScene(scene.model, data, option, None, camera, every, drawn)


def test_the_rooms_own_cameras_are_used() -> None:
    scene = build_scene("paper_room", "nomad200")
    for name in ("top", "overview"):
        camera = fixed_camera(scene, name)
        assert camera.type == mujoco.mjtCamera.mjCAMERA_FIXED
        assert scene.model.camera(camera.fixedcamid).name == f"room/{name}"


@pytest.mark.parametrize("name", ["top", "overview"])
def test_a_room_without_cameras_is_seen_whole(scene: Scene, name: str) -> None:
    camera = fixed_camera(scene, name)
    drawn = mujoco.MjvScene(scene.model, 1000)
    data = place(scene, 3.0, 2.0)
    look(scene, data, camera, drawn)
    eye = drawn.camera[0]
    corners = np.array([[x, y, z] for x in (-0.2, 6.2) for y in (-0.2, 4.2) for z in (0.0, 0.9)])
    off = corners - eye.pos
    right = np.cross(eye.forward, eye.up)
    depth = off @ eye.forward
    assert (depth > 0).all()
    reach = math.tan(math.radians(45.0) / 2)  # half the height of a square picture
    assert (np.abs(off @ eye.up / depth) < reach).all()
    assert (np.abs(off @ right / depth) < reach).all()


def test_the_chase_camera_swings_without_overshooting_whatever_the_frame_rate(
    scene: Scene,
) -> None:
    data = place(scene, 3.0, 2.0)
    ends: list[float] = []
    for steps in (15, 150):
        chase = ChaseCamera(scene)
        chase.cut(data, math.radians(170))
        seen: list[float] = []
        for _ in range(steps):
            chase.follow(data, math.radians(-100), 1.5 / steps)  # the short way: 90 deg left
            seen.append(chase.camera.azimuth % 360)
        assert (np.diff(seen) > 0).all() and seen[-1] < 260
        ends.append(seen[-1])
    assert ends[0] == pytest.approx(ends[1], abs=1e-6)
    assert ends[0] > 235


def test_the_chase_camera_looks_at_the_robot_from_behind(scene: Scene) -> None:
    data = place(scene, 4.0, 2.0)
    chase = ChaseCamera(scene)
    chase.cut(data, 0.0)
    base = data.xpos[scene.robot.footing.base]
    np.testing.assert_allclose(base[:2], [4.0, 2.0])
    assert chase.camera.azimuth == 0 and chase.camera.lookat[0] > base[0]


def test_the_chase_camera_rises_over_a_wall_behind_the_robot(scene: Scene) -> None:
    chase = ChaseCamera(scene)
    chase.cut(place(scene, 4.0, 2.0), 0.0)
    free = chase.camera.elevation
    chase.cut(place(scene, 0.4, 2.0), 0.0)
    assert chase.camera.elevation < free - 10


def test_the_sky_is_drawn_where_it_shows(scene: Scene) -> None:
    data, drawn = place(scene, 3.0, 2.0), mujoco.MjvScene(scene.model, 1000)
    chase = ChaseCamera(scene)
    chase.cut(data, 0.3)
    for camera in (chase.camera, fixed_camera(scene, "top"), fixed_camera(scene, "overview")):
        look(scene, data, camera, drawn)
        assert not sees_sky(drawn)
    for elevation in (-18.0, 0.0, 45.0):
        chase.camera.elevation = elevation
        look(scene, data, chase.camera, drawn)
        assert sees_sky(drawn)
