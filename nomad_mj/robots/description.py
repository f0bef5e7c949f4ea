"""What the rest of the package has to know of a robot, read from its compiled MJCF."""

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from nomad_mj.motion import Drive, SynchroDrive
from nomad_mj.robots.drives import Encoders, find_drive
from nomad_mj.robots.extent import collides, highest, perimeter
from nomad_mj.robots.footing import Footing, find_footing
from nomad_mj.robots.naming import PREFIX, NamedModel
from nomad_mj.robots.rings import RayIndex, index_rays
from nomad_mj.types import IntArray, MotionLimits, Pose, RangeRing, SensorLayout

_BEHIND = (np.radians(150), np.radians(180), np.radians(210))  # where one looks who backs off
_GAP = np.radians(15)  # between cones that together still see behind


@dataclass(frozen=True)
class RobotDescription:
    """A robot as the tasks and the agents see it.

    Attributes
    ----------
    name : str
        The robot's name, for messages and checkpoints.
    layout : SensorLayout
        Size and rings of range sensors.
    drive : Drive
        How it moves.
    motors : array (M,)
        Numbers of the actuators of `drive.motors`.
    controls : array (M,)
        Where their commands are in ``ctrl``.
    encoders : Encoders
        Where the encoders are.
    footing : Footing
        Where its pose is, and how to place it.
    height : float
        Height of the robot above the floor [m]; what hangs higher is no obstacle.
    bumpers : tuple of str
        Names of the touch sensors, without the prefix, in order.
    rays : RayIndex
        Where the rays of the range sensors are in ``sensordata``.
    """

    name: str
    layout: SensorLayout
    drive: Drive
    motors: IntArray
    controls: IntArray
    encoders: Encoders
    footing: Footing
    height: float
    bumpers: tuple[str, ...]
    rays: RayIndex

    @property
    def limits(self) -> MotionLimits:
        """Largest speeds and accelerations."""
        return self.drive.limits

    @property
    def reach(self) -> float:
        """From the robot's centre to the far end of its longest ray, at most [m]."""
        return self.layout.radius + float(self.rays.maximum.max()) + 0.01


def robot_geoms(model: mujoco.MjModel) -> list[int]:
    """Return the indices of the robot's geoms, those that collide and those that only show."""
    names = [
        mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, i) or "" for i in range(model.nbody)
    ]
    own = np.array([name.startswith(PREFIX) for name in names])
    return [int(i) for i in np.flatnonzero(own[model.geom_bodyid])]


def solid_radius(model: mujoco.MjModel, footing: Footing) -> float:
    """Return how far from its base what collides of the robot reaches [m]; 0 if nothing does."""
    data, solid = _standing(model, footing), collides(model)
    geoms = [geom for geom in robot_geoms(model) if solid[geom]]
    return perimeter(model, data, geoms, data.xpos[footing.base])


def _standing(model: mujoco.MjModel, footing: Footing) -> mujoco.MjData:
    """Return where everything is when the robot stands at the origin."""
    data = mujoco.MjData(model)
    footing.place(data.qpos, Pose(0.0, 0.0, 0.0))
    mujoco.mj_kinematics(model, data)
    return data


def _sizes(named: NamedModel, footing: Footing) -> tuple[float, float]:
    """Return radius and height of the robot as it stands on the floor [m]."""
    model = named.model
    radius = named.find_number("radius") or solid_radius(model, footing)
    if not radius > 0:
        raise named.error(
            " lacks its radius: add <custom><numeric name='radius' data=.../></custom>, or geoms "
            "that collide"
        )
    return radius, highest(model, _standing(model, footing), robot_geoms(model))


def sees_behind(rings: tuple[RangeRing, ...]) -> bool:
    """Return whether range sensors look to where a robot drives backwards."""
    cones = [(bearing, ring.half_angle) for ring in rings for bearing in ring.bearings]
    return all(
        any(abs(np.angle(np.exp(1j * (way - axis)))) <= half + _GAP for axis, half in cones)
        for way in _BEHIND
    )


def describe_robot(model: mujoco.MjModel, name: str) -> RobotDescription:
    """Return the description of the robot that `model` holds under the prefix ``robot/``.

    Raises
    ------
    ModelError
        An actuator, joint, range sensor or number that is missing or makes no sense: names it and
        lists what there is or says what it must be.
    """
    named = NamedModel(model, name)
    driven = find_drive(named)
    footing = find_footing(named, driven.steer)
    radius, height = _sizes(named, footing)
    mount = footing.base if driven.turret < 0 else int(model.jnt_bodyid[driven.turret])
    rays, rings = index_rays(named, radius, mount)
    drive = driven.drive
    if not isinstance(drive, SynchroDrive):
        drive = replace(drive, sees_behind=sees_behind(rings))
    touch = np.flatnonzero(model.sensor_type == mujoco.mjtSensor.mjSENS_TOUCH)
    bumpers = [model.sensor(int(i)).name for i in touch]
    return RobotDescription(
        name=name,
        layout=SensorLayout(radius, rings),
        drive=drive,
        motors=driven.motors,
        controls=model.actuator_ctrladr[driven.motors],
        encoders=driven.encoders,
        footing=footing,
        height=height,
        bumpers=tuple(b.removeprefix(PREFIX) for b in bumpers if b.startswith(PREFIX)),
        rays=rays,
    )
