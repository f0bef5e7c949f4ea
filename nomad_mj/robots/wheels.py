"""Wheels in a compiled model: where they stand, which way they roll, how large they are."""

import math

import mujoco
import numpy as np

from nomad_mj.motion import WheeledDrive
from nomad_mj.robots.extent import collides, lowest
from nomad_mj.robots.footing import find_base
from nomad_mj.robots.naming import NamedModel
from nomad_mj.types import FloatArray, MotionLimits

_TRANSMISSION = mujoco.mjtTrn
_ON = tuple(
    int(kind)
    for kind in (
        _TRANSMISSION.mjTRN_JOINT,
        _TRANSMISSION.mjTRN_JOINTINPARENT,
        _TRANSMISSION.mjTRN_SITE,
    )
)
_PLAIN = mujoco.mjtDyn.mjDYN_NONE
_LEVEL = 0.1  # an axle's vertical part, at most


def joint_of(model: mujoco.MjModel, actuator: int) -> int:
    """Return the joint that an actuator acts on, -1 if it acts on something else."""
    kinds = (int(_TRANSMISSION.mjTRN_JOINT), int(_TRANSMISSION.mjTRN_JOINTINPARENT))
    on_joint = int(model.actuator_trntype[actuator]) in kinds
    return int(model.actuator_trnid[actuator, 0]) if on_joint else -1


def is_velocity_servo(model: mujoco.MjModel, actuator: int) -> bool:
    """Return whether an actuator takes a speed: <velocity>, or what amounts to it."""
    if model.actuator_ctrlnum[actuator] != 1 or model.actuator_dyntype[actuator] != _PLAIN:
        return False
    affine = model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_AFFINE
    gain, bias = model.actuator_gainprm[actuator], model.actuator_biasprm[actuator]
    return bool(affine and gain[0] > 0 and bias[1] == 0 and math.isclose(bias[2], -gain[0]))


def top_speed(named: NamedModel, name: str, actuator: int) -> float:
    """Return the largest command of a motor, both ways."""
    model = named.model
    control = int(model.actuator_ctrladr[actuator])  # actuators without a control come between
    if not model.actuator_ctrllimited[control] or model.actuator_ctrlrange[control, 1] <= 0:
        raise named.error(
            f": actuator {name!r} needs a ctrlrange, its largest speed (or angle) both ways"
        )
    return float(model.actuator_ctrlrange[control, 1])


class Wheel:
    """A wheel at rest, in the robot's frame.

    Attributes
    ----------
    place : array (2,)
        Where it touches the floor [m].
    rolls : array (2,)
        Direction in which it rolls forward.
    gain : float
        Command of its motor per speed on the floor [1/(m/s)].
    """

    def __init__(self, named: NamedModel, name: str, actuator: int) -> None:
        model = named.model
        base = find_base(named)
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        frame = data.xmat[base].reshape(3, 3)
        gear = model.actuator_gear[actuator]
        joint = joint_of(model, actuator)
        if joint >= 0:
            axis = data.xaxis[joint]
            self.place = _contact(model, data, joint)
            direction = np.cross(axis, [0.0, 0.0, 1.0])
            radius = named.find_number("wheel_radius") or _radius(model, data, joint)
            if not radius > 0:
                raise named.error(f": wheel_radius of {name!r} cannot be measured; give the number")
            self.gain = float(gear[0]) / radius
        else:
            site = int(model.actuator_trnid[actuator, 0])
            direction = data.site_xmat[site].reshape(3, 3) @ gear[:3]
            self.place = data.site_xpos[site].copy()
            self.gain = 1.0
        if not self.gain:
            raise named.error(f": actuator {name!r} has no gear, so it moves nothing")
        self.place = ((self.place - data.xpos[base]) @ frame)[:2]
        rolls = (direction @ frame)[:2]
        length = float(np.hypot(*rolls))
        self.rolls = rolls / length if length else rolls
        rollers = math.tan(math.radians(named.any_number(f"{name}_rollers")))
        self.rolls = self.rolls + rollers * np.array([-self.rolls[1], self.rolls[0]])

    @property
    def row(self) -> tuple[float, float, float]:
        """Its speed per speed of the robot forward, to the left and turning left."""
        (x, y), (along, across) = self.place.tolist(), self.rolls.tolist()
        return along, across, x * across - y * along


def _solid(model: mujoco.MjModel, joint: int) -> list[int]:
    """Return the geoms of a joint's body, those that collide if there are any."""
    body = int(model.jnt_bodyid[joint])
    own = np.flatnonzero(model.geom_bodyid == body).tolist()
    solid = collides(model)
    return [geom for geom in own if solid[geom]] or own


def _contact(model: mujoco.MjModel, data: mujoco.MjData, joint: int) -> FloatArray:
    geoms = _solid(model, joint)
    return data.geom_xpos[geoms].mean(axis=0) if geoms else data.xanchor[joint].copy()


def _radius(model: mujoco.MjModel, data: mujoco.MjData, joint: int) -> float:
    """Return how far a wheel's lowest point is below its axle [m]."""
    geoms = _solid(model, joint)
    return float(data.xanchor[joint][2]) - lowest(model, data, geoms) if geoms else 0.0


def find_wheels(named: NamedModel, actuators: dict[str, int]) -> list[str]:
    """Return the names of the actuators that roll the wheels.

    Raises
    ------
    ModelError
        There are fewer than two, or one of those named is no velocity servo.
    """
    model = named.model
    given = named.text("motors").splitlines()
    for name in given:
        named.require("actuator", name, actuators)
        if not is_velocity_servo(model, actuators[name]):
            raise named.error(f": actuator {name!r} takes no speed; write it as <velocity kv=...>")
        if int(model.actuator_trntype[actuators[name]]) not in _ON:
            raise named.error(f": actuator {name!r} must act on a joint, or on a site")
    found = given or [name for name, index in actuators.items() if _rolls(model, index)]
    if len(found) < 2:
        raise named.error(
            " has no drive: it needs velocity servos named translate and steer, drive and steer, "
            "or on two wheels at least; actuators it has: " + (", ".join(actuators) or "none")
        )
    return found


def _rolls(model: mujoco.MjModel, actuator: int) -> bool:
    """Return whether an actuator may be that of a wheel."""
    if not is_velocity_servo(model, actuator):
        return False
    if model.actuator_trntype[actuator] == _TRANSMISSION.mjTRN_SITE:
        return bool(np.any(model.actuator_gear[actuator, :2]))
    joint = joint_of(model, actuator)
    if joint < 0 or model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_HINGE:
        return False
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return abs(float(data.xaxis[joint][2])) < _LEVEL


def wheeled_drive(
    named: NamedModel,
    names: list[str],
    accelerations: tuple[float, float],
    kind: str,
) -> WheeledDrive:
    """Return the drive that wheels make, of a kind if one is given.

    `accelerations` [m/s2], [rad/s2] are those where the file says nothing.
    """
    actuators = named.actuators()
    wheels = [Wheel(named, name, actuators[name]) for name in names]
    rows = np.array([wheel.row for wheel in wheels])
    track = named.find_number("track")
    if track is not None:  # as odometry is calibrated: the distance of tyres that turns tell
        rows[:, 2] *= track / max(float(np.ptp(rows[:, 2] / rows[:, 0])), 1e-9)
    tops = [top_speed(named, name, actuators[name]) for name in names]
    fastest = [top / abs(wheel.gain) for top, wheel in zip(tops, wheels, strict=True)]
    rank = int(np.linalg.matrix_rank(rows, tol=1e-3))
    if kind and (rank == 3) != (kind == "omni"):
        raise named.error(f": it is said to be {kind}, but its wheels are not")
    if rank < 2 or (np.any(np.abs(rows[:, 0]) < 1e-3) and rank < 3):
        raise named.error(f": its wheels {', '.join(names)} can only drive, or only turn it")
    directions = rows[:, :2] if rank == 3 else rows[:, :1]
    along = float(np.min(np.array(fastest) / np.linalg.norm(directions, axis=1)))
    turning = float(np.min(np.array(fastest) / np.maximum(np.abs(rows[:, 2]), 1e-9)))
    limits = MotionLimits(
        named.number("translate_max_speed", along),
        named.number("translate_max_acceleration", accelerations[0]),
        named.number("turn_max_speed", turning),
        named.number("turn_max_acceleration", accelerations[1]),
    )
    return WheeledDrive(
        limits,
        tuple(names),
        tuple((row[0], row[1], row[2]) for row in rows.tolist()),
        tuple(wheel.gain for wheel in wheels),
        tuple(fastest),
        0.0 if rank == 3 else -float(np.mean([wheel.place[0] for wheel in wheels])),
    )
