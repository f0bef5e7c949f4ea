"""The drive of a robot's file: which motors there are, and what they do to the robot."""

from typing import NamedTuple

import mujoco
import numpy as np

from nomad_mj.motion import CarDrive, SynchroDrive, WheeledDrive
from nomad_mj.robots.footing import find_base
from nomad_mj.robots.naming import NamedModel
from nomad_mj.robots.wheels import (
    Wheel,
    find_wheels,
    is_velocity_servo,
    joint_of,
    top_speed,
    wheeled_drive,
)
from nomad_mj.types import FloatArray, IntArray, MotionLimits

_SYNCHRO = ("translate", "steer", "turret")
_ACCELERATION = 0.76  # [m/s2] where the file says nothing, that of the Nomad 200
_TURN_ACCELERATION = 2.0  # [rad/s2]
_UPRIGHT = 0.9  # vertical part of the axis of a hinge that steers; some are raked


class Encoders(NamedTuple):
    """Where the encoders are, W that count a way and A that read an angle.

    Attributes
    ----------
    speeds : array (W,)
        Numbers of the sensors that give a motor's speed.
    scales : array (W,)
        Way on the floor [m] per integral of that speed.
    angles : array (A,)
        Addresses in ``qpos`` [rad].
    """

    speeds: IntArray
    scales: FloatArray
    angles: IntArray


class Driven(NamedTuple):
    """A drive and what it needs of the simulation; `steer` is a joint, -1 if the base turns."""

    drive: SynchroDrive | WheeledDrive | CarDrive
    encoders: Encoders
    motors: IntArray
    steer: int
    turret: int


def find_drive(named: NamedModel) -> Driven:
    """Return how a robot drives, as if it did not see behind itself.

    Raises
    ------
    ModelError
        No drive can be made of the actuators, or one lacks its limits: names it.
    """
    actuators = named.actuators()
    kind = named.text("drive") or _guess(actuators)
    if kind == "synchro":
        return _synchro(named, actuators)
    if kind == "car":
        return _car(named, actuators)
    wheels = find_wheels(named, actuators)
    drive = wheeled_drive(named, wheels, (_ACCELERATION, _TURN_ACCELERATION), kind)
    ids = [actuators[wheel] for wheel in wheels]
    encoders = _encoders(named, ids, [1 / gain for gain in drive.gains], [])
    return Driven(drive, encoders, np.array(ids), -1, -1)


def _guess(actuators: dict[str, int]) -> str:
    """Return the kind of drive that names tell, empty for wheels."""
    if sum(name in actuators for name in _SYNCHRO) >= 2:
        return "synchro"
    return "car" if "drive" in actuators and "steer" in actuators else ""


def _encoders(
    named: NamedModel, ids: list[int], scales: list[float], joints: list[int]
) -> Encoders:
    """Return the encoders of motors that count a way and of joints that have an angle."""
    model = named.model
    kind = mujoco.mjtSensor.mjSENS_ACTUATORVEL
    speeds: list[int] = []
    for actuator in ids:
        found = np.flatnonzero((model.sensor_type == kind) & (model.sensor_objid == actuator))
        speeds.append(int(found[0]))  # adopt() has seen to it that there is one
    angles = np.array([int(model.jnt_qposadr[j]) for j in joints], dtype=np.intp)
    return Encoders(np.array(speeds), np.array(scales), angles)


def _require_servo(named: NamedModel, name: str, actuator: int) -> None:
    if not is_velocity_servo(named.model, actuator):
        raise named.error(f": actuator {name!r} takes no speed; write it as <velocity kv=...>")


def _hinge(named: NamedModel, name: str, actuator: int) -> int:
    """Return the hinge that a motor turns, to the left with what it is commanded."""
    model = named.model
    joint = joint_of(model, actuator)
    if joint < 0 or model.jnt_type[joint] != mujoco.mjtJoint.mjJNT_HINGE:
        raise named.error(f": joint {name!r} must be a hinge that the actuator {name!r} turns")
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    if data.xaxis[joint][2] < _UPRIGHT or model.actuator_gear[actuator, 0] <= 0:
        raise named.error(
            f": actuator {name!r} must turn to the left; let the axis of its hinge point up, "
            "and its gear be above 0"
        )
    return joint


def _synchro(named: NamedModel, actuators: dict[str, int]) -> Driven:
    joints = named.names(mujoco.mjtObj.mjOBJ_JOINT, named.model.njnt)
    names = _SYNCHRO if "turret" in joints or "turret" in actuators else _SYNCHRO[:2]
    ids = [named.require("actuator", name, actuators) for name in names]
    _require_servo(named, names[0], ids[0])
    speeds = [top_speed(named, *motor) for motor in zip(names, ids, strict=True)]
    hinges = [_hinge(named, *motor) for motor in zip(names[1:], ids[1:], strict=True)]
    limits = MotionLimits(
        named.number("translate_max_speed", speeds[0]),
        named.number("translate_max_acceleration", _ACCELERATION),
        named.number("turn_max_speed", speeds[1]),
        named.number("steer_max_acceleration", _TURN_ACCELERATION),
    )
    encoders = _encoders(named, ids[:1], [1.0], hinges)
    turret = hinges[1] if len(hinges) > 1 else -1
    return Driven(SynchroDrive(limits, turret >= 0), encoders, np.array(ids), hinges[0], turret)


def _ahead(named: NamedModel, joint: int) -> float:
    """Return how far ahead of the robot's origin a joint is [m]."""
    data = mujoco.MjData(named.model)
    mujoco.mj_kinematics(named.model, data)
    base = find_base(named)
    offset = data.xanchor[joint] - data.xpos[base]
    return float(offset @ data.xmat[base].reshape(3, 3)[:, 0])


def _car(named: NamedModel, actuators: dict[str, int]) -> Driven:
    groups = [
        [name for name in actuators if name == role or name.removeprefix(role + "_").isdigit()]
        for role in ("drive", "steer")
    ]
    for role, group in zip(("drive", "steer"), groups, strict=True):
        if not group:
            named.require("actuator", role, actuators)
    driven, steered = ([actuators[name] for name in group] for group in groups)
    for motor in zip(groups[0], driven, strict=True):
        _require_servo(named, *motor)
    wheels = [Wheel(named, *motor) for motor in zip(groups[0], driven, strict=True)]
    gains = [wheel.gain for wheel in wheels]
    hinges = [_hinge(named, *motor) for motor in zip(groups[1], steered, strict=True)]
    rear = float(np.mean([wheel.place[0] for wheel in wheels]))
    front = float(np.mean([_ahead(named, joint) for joint in hinges]))
    wheelbase = named.find_number("wheelbase") or front - rear
    if wheelbase < 1e-3:
        raise named.error(": its steered wheels must be ahead of its driven ones; turn x ahead")
    lock = min(top_speed(named, *motor) for motor in zip(groups[1], steered, strict=True))
    if lock >= np.pi / 2:
        raise named.error(
            f": its lock, the ctrlrange of {groups[1][0]!r}, is {lock:g} rad; it must be below a "
            "right angle, 1.57 (the engine takes no degrees there)"
        )
    fastest = named.number(
        "translate_max_speed",
        min(
            top_speed(named, name, actuator) / abs(gain)
            for name, actuator, gain in zip(groups[0], driven, gains, strict=True)
        ),
    )
    limits = MotionLimits(
        fastest,
        named.number("translate_max_acceleration", _ACCELERATION),
        named.number("turn_max_speed", fastest * float(np.tan(lock)) / wheelbase),
        named.number("turn_max_acceleration", _TURN_ACCELERATION),
    )
    drive = CarDrive(
        limits, tuple(groups[0]), tuple(gains), tuple(groups[1]), wheelbase, -rear, lock
    )
    encoders = _encoders(named, driven, [1 / gain for gain in gains], hinges)
    return Driven(drive, encoders, np.array(driven + steered), -1, -1)
