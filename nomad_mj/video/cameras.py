"""Cameras: those of the room and of the robot, and computed ones where a file has none."""

import math

import mujoco
import numpy as np

from nomad_mj.arenas.names import ROOM_PREFIX
from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray

_DISTANCE = 4.3  # [m] from the chase camera to what it looks at
_AHEAD = 0.8  # [m] before the robot that it looks at
_HEIGHT = 0.35  # [m] above the floor that it looks at
_WALL = 1.0  # [m] that walls are high, roughly
_CLIMBS = (33.0, 39.0, 45.0, 51.0, 57.0, 63.0, 69.0)  # [deg] above the horizon
_SWING = 2.2  # [rad/s] of a critically damped swing
_RISE = 1.6  # [1/s] with which it climbs over walls


def _free_camera() -> mujoco.MjvCamera:
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    return camera


def _room_camera(scene: Scene, elevation: float) -> mujoco.MjvCamera:
    """Return a camera that sees all of the floor plan from `elevation` [deg] up."""
    x0, y0, x1, y1 = scene.shown_bounds
    middle = np.array([(x0 + x1) / 2, (y0 + y1) / 2, 0.0])
    corners = np.array([[x, y, z] for x in (x0, x1) for y in (y0, y1) for z in (0.0, _WALL)])
    corners -= middle
    sin, cos = math.sin(math.radians(elevation)), math.cos(math.radians(elevation))
    depth = corners @ np.array([0.0, cos, -sin])
    aside = np.maximum(np.abs(corners[:, 0]), np.abs(corners @ np.array([0.0, sin, cos])))
    tangent = math.tan(math.radians(float(scene.model.vis.global_.fovy)) / 2)
    camera = _free_camera()
    camera.lookat, camera.azimuth, camera.elevation = middle, 90.0, -elevation
    camera.distance = float(np.max(1.04 * aside / tangent - depth))
    return camera


def fixed_camera(scene: Scene, name: str) -> mujoco.MjvCamera:
    """Return the room's camera `name`, "top" or "overview", or one that sees the whole room."""
    kind = mujoco.mjtObj.mjOBJ_CAMERA
    index = int(mujoco.mj_name2id(scene.model, kind, ROOM_PREFIX + name))
    if index < 0:
        return _room_camera(scene, 90.0 if name == "top" else 55.0)
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
    camera.fixedcamid = index
    return camera


class ChaseCamera:
    """Follows behind the robot's course, swings gently, and rises over walls in its way.

    Parameters
    ----------
    scene : Scene
        Robot and room.

    Attributes
    ----------
    camera : mujoco.MjvCamera
        To draw with.
    """

    def __init__(self, scene: Scene) -> None:
        self._model = scene.model
        self._start = scene.robot.layout.radius + 0.05
        self.camera = _free_camera()
        self.camera.distance = _DISTANCE
        self._base = scene.robot.footing.base
        self._azimuth = self._speed = 0.0
        self._climb = math.radians(_CLIMBS[0])

    def cut(self, data: mujoco.MjData, course: float) -> None:
        """Jump behind the robot, which is about to drive along `course` [rad]."""
        self._azimuth, self._speed = course, 0.0
        self._climb = self._free_climb(data)
        self._aim(data)

    def follow(self, data: mujoco.MjData, course: float, elapsed: float) -> None:
        """Move on by `elapsed` seconds of the video."""
        error = math.remainder(course - self._azimuth, 2 * math.pi)
        # Exact for a critically damped spring whose target rests: never overshoots, any step.
        decay = math.exp(-_SWING * elapsed)
        rate = self._speed - _SWING * error
        error, self._speed = (
            (error - rate * elapsed) * decay,
            (self._speed - rate * _SWING * elapsed) * decay,
        )
        self._azimuth = course - error
        share = 1 - math.exp(-_RISE * elapsed)
        self._climb += share * (self._free_climb(data) - self._climb)
        self._aim(data)

    def _free_climb(self, data: mujoco.MjData) -> float:
        """Return the lowest elevation [rad] from which no wall hides the robot."""
        back = np.array([-math.cos(self._azimuth), -math.sin(self._azimuth)])
        base: FloatArray = data.xpos[self._base]
        start = np.array([*(base[:2] + self._start * back), 0.25])
        hit = np.zeros(1, dtype=np.int32)
        for climb in map(math.radians, _CLIMBS):
            ray = np.array([*(back * math.cos(climb)), math.sin(climb)])
            met = mujoco.mj_ray(self._model, data, start, ray, None, 1, -1, hit)
            if met < 0 or met > _DISTANCE:
                return climb
        return math.radians(_CLIMBS[-1])

    def _aim(self, data: mujoco.MjData) -> None:
        ahead = _AHEAD * np.array([math.cos(self._azimuth), math.sin(self._azimuth)])
        self.camera.lookat = np.array([*(data.xpos[self._base][:2] + ahead), _HEIGHT])
        self.camera.azimuth = math.degrees(self._azimuth)
        self.camera.elevation = -math.degrees(self._climb)
