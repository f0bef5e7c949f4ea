"""What the rest of the package has to know of a robot, read from its compiled MJCF."""

from dataclasses import dataclass

import mujoco
import numpy as np

from nomad_mj.errors import ModelError
from nomad_mj.robots.rings import PREFIX, RayIndex, index_rays
from nomad_mj.types import MotionLimits, SensorLayout

ACTUATORS = ("translate", "steer", "turret")
JOINTS = ("base_x", "base_y", "steer", "turret")
ENCODERS = ("translate_encoder", "steer_encoder", "turret_encoder")


@dataclass(frozen=True)
class RobotDescription:
    """A robot as the tasks and the agents see it.

    Attributes
    ----------
    name : str
        The robot's name, for messages and checkpoints.
    layout : SensorLayout
        Size and rings of range sensors.
    limits : MotionLimits
        Speeds and accelerations of the motors.
    height : float
        Height of the robot above the floor [m]; what hangs higher is no obstacle.
    bumpers : tuple of str
        Names of the touch sensors, without the prefix, in order.
    rays : RayIndex
        Where the rays of the range sensors are in ``sensordata``.
    """

    name: str
    layout: SensorLayout
    limits: MotionLimits
    height: float
    bumpers: tuple[str, ...]
    rays: RayIndex


def _require(
    model: mujoco.MjModel, robot: str, kind: mujoco.mjtObj, names: tuple[str, ...]
) -> None:
    """Raise a ModelError that names the missing elements and lists those that there are."""
    missing = [n for n in names if mujoco.mj_name2id(model, kind, PREFIX + n) < 0]
    if not missing:
        return
    what = kind.name.removeprefix("mjOBJ_").lower()
    counts = {"actuator": model.nu, "joint": model.njnt, "sensor": model.nsensor}
    present = [mujoco.mj_id2name(model, kind, i) or "" for i in range(counts[what])]
    own = [n.removeprefix(PREFIX) for n in present if n.startswith(PREFIX)]
    listed = ", ".join(own[:12]) + (", ..." if len(own) > 12 else "") if own else "none"
    raise ModelError(f"robot {robot!r} lacks the {what} {missing[0]!r}; {what}s it has: {listed}")


def _number(model: mujoco.MjModel, robot: str, name: str, default: float | None = None) -> float:
    """Return the custom numeric `name` of the robot."""
    index = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_NUMERIC, PREFIX + name)
    if index >= 0:
        value = float(model.numeric_data[model.numeric_adr[index]])
        if not (value > 0 or value == default):
            raise ModelError(f"robot {robot!r}: its {name} is {value:g}; it must be above 0")
        return value
    if default is None:
        raise ModelError(
            f"robot {robot!r} lacks its {name}: add <custom><numeric name={name!r} data=.../>"
            "</custom>"
        )
    return default


def _limits(model: mujoco.MjModel, robot: str) -> MotionLimits:
    speeds: list[float] = []
    for name in ACTUATORS:
        actuator = model.actuator(PREFIX + name)
        if not actuator.ctrllimited[0] or actuator.ctrlrange[1] <= 0:
            raise ModelError(
                f"robot {robot!r}: actuator {name!r} needs a ctrlrange, its largest speed both ways"
            )
        speeds.append(float(actuator.ctrlrange[1]))
    return MotionLimits(
        translate=speeds[0],
        translate_acceleration=_number(model, robot, "translate_max_acceleration", 0.76),
        steer=speeds[1],
        steer_acceleration=_number(model, robot, "steer_max_acceleration", 2.0),
        turret=speeds[2],
        turret_acceleration=_number(model, robot, "turret_max_acceleration", 2.0),
    )


def robot_geoms(model: mujoco.MjModel) -> list[int]:
    """Return the indices of the robot's geoms, those that collide and those that only show."""
    names = [
        mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, i) or "" for i in range(model.nbody)
    ]
    own = np.array([name.startswith(PREFIX) for name in names])
    return [int(i) for i in np.flatnonzero(own[model.geom_bodyid])]


def _height(model: mujoco.MjModel) -> float:
    """Return the height of the highest point of the robot [m]."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    top = [0.0]
    for geom in robot_geoms(model):
        axes = np.abs(data.geom_xmat[geom].reshape(3, 3))
        centre, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
        middle = data.geom_xpos[geom] + data.geom_xmat[geom].reshape(3, 3) @ centre
        top.append(float(middle[2] + axes[2] @ half))
    return max(top)


def describe_robot(model: mujoco.MjModel, name: str) -> RobotDescription:
    """Return the description of the robot that `model` holds under the prefix ``robot/``.

    Raises
    ------
    ModelError
        An actuator, joint, encoder, range sensor or number that is missing or makes no sense:
        names it and lists what there is or says what it must be.
    """
    _require(model, name, mujoco.mjtObj.mjOBJ_ACTUATOR, ACTUATORS)
    _require(model, name, mujoco.mjtObj.mjOBJ_JOINT, JOINTS)
    _require(model, name, mujoco.mjtObj.mjOBJ_SENSOR, ENCODERS)
    for joint in JOINTS:
        kind = "slide" if joint.startswith("base_") else "hinge"
        if model.joint(PREFIX + joint).type[0] != getattr(mujoco.mjtJoint, f"mjJNT_{kind.upper()}"):
            raise ModelError(f"robot {name!r}: joint {joint!r} must be a {kind}")
    radius = _number(model, name, "radius")
    rays, rings = index_rays(model, name, radius, lambda key: _number(model, name, key, 0.0))
    touch = np.flatnonzero(model.sensor_type == mujoco.mjtSensor.mjSENS_TOUCH)
    bumpers = [model.sensor(int(i)).name for i in touch]
    return RobotDescription(
        name=name,
        layout=SensorLayout(radius, rings),
        limits=_limits(model, name),
        height=_height(model),
        bumpers=tuple(b.removeprefix(PREFIX) for b in bumpers if b.startswith(PREFIX)),
        rays=rays,
    )
