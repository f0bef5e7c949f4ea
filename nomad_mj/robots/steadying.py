"""Motors have inertia too: wheels of files that leave it out get some.

A velocity servo on a wheel that weighs next to nothing, integrated implicitly, lets the robot run
ahead of its wheels: a cart of 2 kg turned 31 degrees less in a full turn than its wheels said, and
1.6 degrees with what follows. A geared motor's rotor, seen from the wheel, weighs as much.
"""

import mujoco
import numpy as np

from nomad_mj.robots.extent import lowest

_SHARE = 0.35  # of the inertia that a wheel would have with all the robot's mass at its rim
_LEVEL = 0.1  # an axle's vertical part, at most


def steady_wheels(spec: mujoco.MjSpec) -> None:
    """Give driven wheels without armature that of a geared motor.

    Parameters
    ----------
    spec : mujoco.MjSpec
        A robot; changed in place.
    """
    bare = [
        joint
        for joint in spec.joints
        if joint.type == mujoco.mjtJoint.mjJNT_HINGE
        and not joint.armature
        and any(_drives(actuator, joint.name) for actuator in spec.actuators)
    ]
    if not bare:
        return
    model = spec.copy().compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mass = float(model.body_mass.sum())
    for joint in bare:
        index = model.joint(joint.name).id
        own = np.flatnonzero(model.geom_bodyid == model.jnt_bodyid[index]).tolist()
        radius = float(data.xanchor[index][2]) - lowest(model, data, own) if own else 0.0
        if abs(data.xaxis[index][2]) < _LEVEL and radius > 0:
            joint.armature = _SHARE * mass * radius**2


def _drives(actuator: mujoco.MjsActuator, joint: str) -> bool:
    """Return whether an actuator is a velocity servo on a joint."""
    on_joint = actuator.trntype == mujoco.mjtTrn.mjTRN_JOINT and actuator.target == joint
    gain, bias = float(actuator.gainprm[0]), float(actuator.biasprm[2])
    return bool(on_joint and gain > 0 and bias == -gain and actuator.biasprm[1] == 0)
