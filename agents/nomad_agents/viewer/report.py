"""A session in plain data, as the page shows it."""

import math
from typing import Any

import mujoco
import numpy as np

from nomad_agents.viewer.session import Session
from nomad_mj.robots import PREFIX
from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray


def facts(session: Session) -> dict[str, Any]:
    """Return what does not change: the robot, its sensors, the room, who can drive.

    Lengths in metres, angles in radians.
    """
    scene = session.env.scene
    robot = scene.robot
    return {
        "robot": robot.name,
        "room": scene.arena.name,
        "agent": session.agent.name if session.agent else "",
        "drive": robot.drive.kind,
        "radius": robot.layout.radius,
        "fastest": robot.limits.translate,
        "rings": [
            {
                "name": ring.name,
                "bearings": list(ring.bearings),
                "half_angle": ring.half_angle,
                "max_range": ring.max_range,
            }
            for ring in robot.layout.rings
        ],
        "bumpers": len(robot.bumpers),
    }


class Reporter:
    """Says how a session stands, in directions as the driver sees them: 0 ahead, left positive.

    Parameters
    ----------
    session : Session
        What to report.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._bumpers = _bumper_sites(session.env.scene)

    def state(self) -> dict[str, Any]:
        """Return time, place, readings and what happens: metres, seconds, radians."""
        session, physics = self._session, self._session.env.physics
        task, layout = session.env.motor.task, session.env.scene.robot.layout
        pose = physics.pose()
        goal = task.goal - np.array(pose[:2])
        ranges, first = dict[str, list[float]](), 0
        for ring in layout.rings:
            last = first + len(ring.bearings)
            ranges[ring.name] = np.round(task.ranges[first:last], 3).tolist()
            first = last
        return {
            "episode": session.episodes,
            "time": round(float(physics.data.time), 2),
            "x": round(pose.x, 3),
            "y": round(pose.y, 3),
            "heading": round(math.remainder(pose.heading, 2 * math.pi), 4),
            "sensors": round(math.remainder(task.travel.sensors - pose.heading, 2 * math.pi), 4),
            "speed": round(session.speed, 3),
            "goal": round(task.goal_distance(physics), 3),
            "goal_bearing": round(_bearing(goal, pose.heading), 4),
            "ranges": ranges,
            "touched": self._touched(pose.heading),
            "driver": session.driver,
            "news": session.news,
        }

    def _touched(self, heading: float) -> list[float]:
        """Return where the robot is touched [rad]."""
        data, base = self._session.env.physics.data, self._session.env.scene.robot.footing.base
        sites = [self._bumpers[number] for number in self._session.touched.tolist()]
        aside = [data.site_xpos[site][:2] - data.xpos[base][:2] for site in sites]
        return [round(_bearing(way, heading), 3) for way in aside]


def _bearing(way: FloatArray, heading: float) -> float:
    return math.remainder(math.atan2(float(way[1]), float(way[0])) - heading, 2 * math.pi)


def _bumper_sites(scene: Scene) -> list[int]:
    """Return the site of each touch sensor, in the order of the robot's bumpers."""
    kind = mujoco.mjtObj.mjOBJ_SENSOR
    names = [PREFIX + name for name in scene.robot.bumpers]
    sensors = [mujoco.mj_name2id(scene.model, kind, name) for name in names]
    return [int(scene.model.sensor_objid[sensor]) for sensor in sensors]
