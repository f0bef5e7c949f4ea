"""How a robot stands in the room: the joints that say where it is, and how to put it elsewhere."""

import math
from dataclasses import dataclass

import mujoco
import numpy as np

from nomad_mj.robots.extent import collides, lowest
from nomad_mj.robots.naming import NamedModel
from nomad_mj.types import FloatArray, Pose

_JOINT = mujoco.mjtJoint
_SLACK = 1e-3  # of a joint's axis


@dataclass(frozen=True)
class Footing:
    """Where the robot's pose is in ``qpos``.

    Attributes
    ----------
    base : int
        Body whose frame is the robot's.
    x, y, heading : int
        Addresses; `heading` is that of a hinge, -1 if the robot has a free joint, then `x` is
        that joint's.
    rest : array (5,)
        Height [m] and rotation of a free base that stands on the floor, looking along +x.
    """

    base: int
    x: int
    y: int
    heading: int
    rest: FloatArray

    @property
    def free(self) -> bool:
        """Whether the robot stands on a free joint."""
        return self.heading < 0

    def pose(self, qpos: FloatArray) -> Pose:
        """Return the pose, given ``qpos`` (nq,)."""
        if self.heading >= 0:
            return Pose(qpos.item(self.x), qpos.item(self.y), qpos.item(self.heading))
        x, y, _, w, i, j, k = qpos[self.x : self.x + 7].tolist()
        return Pose(x, y, math.atan2(2 * (w * k + i * j), 1 - 2 * (j * j + k * k)))

    def place(self, qpos: FloatArray, pose: Pose) -> None:
        """Put the robot at a pose in ``qpos`` (nq,), on the floor."""
        qpos[[self.x, self.y]] = pose.x, pose.y
        if self.heading >= 0:
            qpos[self.heading] = pose.heading
            return
        turn = np.array([math.cos(pose.heading / 2), 0.0, 0.0, math.sin(pose.heading / 2)])
        quat = np.empty(4)
        mujoco.mju_mulQuat(quat, turn, self.rest[1:])
        qpos[self.x + 2] = self.rest[0]
        qpos[self.x + 3 : self.x + 7] = quat


def find_base(named: NamedModel) -> int:
    """Return the body whose frame is the robot's: x ahead, z up.

    Raises
    ------
    ModelError
        There are several that it could be.
    """
    model, bodies = named.model, named.bodies()
    given = named.text("base")
    if given:
        return named.require("body", given, bodies)
    tops = {name: index for name, index in bodies.items() if model.body_parentid[index] == 0}
    if "base" in bodies:
        return bodies["base"]
    if len(tops) != 1:
        raise named.error(
            f" has several bodies that could be its base: {', '.join(tops)}; call one base, or say "
            "base: NAME in its data sheet"
            if tops
            else " has no body; it must have one, with a free joint"
        )
    return next(iter(tops.values()))


def find_footing(named: NamedModel, steer: int) -> Footing:
    """Return how the robot stands.

    Parameters
    ----------
    named : NamedModel
        The robot.
    steer : int
        Joint whose angle is the heading where the base itself never turns, -1 if it does.

    Raises
    ------
    ModelError
        The base cannot move in the plane, or cannot turn.
    """
    model, base = named.model, find_base(named)
    joints = [j for body in _chain(model, base) for j in _joints(model, body)]
    free = [j for j in joints if model.jnt_type[j] == _JOINT.mjJNT_FREE]
    if free:
        address = int(model.jnt_qposadr[free[0]])
        footing = Footing(base, address, address + 1, -1, _rest(model, base, address))
        return _checked(named, footing, base)
    found = [_along(model, joints, _JOINT.mjJNT_SLIDE, axis) for axis in ([1, 0, 0], [0, 1, 0])] + [
        steer if steer >= 0 else _along(model, joints, _JOINT.mjJNT_HINGE, [0, 0, 1])
    ]
    if min(found) < 0:
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, base).rpartition("/")[2]
        raise named.error(
            f": its base {name!r} cannot go everywhere: give it a free joint, or slide joints "
            "along x and y" + ("" if steer >= 0 else " and a hinge about z")
        )
    x, y, heading = (int(model.jnt_qposadr[j]) for j in found)
    turned = int(model.jnt_bodyid[found[2]])
    return _checked(named, Footing(base, x, y, heading, np.zeros(5)), turned)


def _checked(named: NamedModel, footing: Footing, turned: int) -> Footing:
    """Return a footing if joints and base agree on where the robot is and, `turned`, looks.

    Raises
    ------
    ModelError
        They do not: the base is turned or moved within the file, or its joints are.
    """
    model, wanted = named.model, Pose(1.0, 2.0, 0.7)
    data = mujoco.MjData(model)
    footing.place(data.qpos, wanted)
    mujoco.mj_kinematics(model, data)
    axes, place = data.xmat[turned].reshape(3, 3), data.xpos[footing.base]
    there = [*place[:2].tolist(), math.atan2(axes[1, 0], axes[0, 0])]
    if not np.allclose([there, list(footing.pose(data.qpos))], list(wanted), atol=1e-4):
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, footing.base).rpartition("/")[2]
        raise named.error(
            f": its base {name!r} is not where its joints say: it must lie at the origin and look "
            "along x where they are 0 (no pos, euler or frame; slides before the hinge), and a "
            "free joint must be its own"
        )
    return footing


def _chain(model: mujoco.MjModel, body: int) -> list[int]:
    """Return a body and those above it, without the world."""
    chain: list[int] = []
    while body:
        chain.append(body)
        body = int(model.body_parentid[body])
    return chain


def _joints(model: mujoco.MjModel, body: int) -> range:
    first = int(model.body_jntadr[body])
    return range(first, first + int(model.body_jntnum[body]))


def _along(model: mujoco.MjModel, joints: list[int], kind: int, axis: list[int]) -> int:
    """Return the joint of a kind along an axis, -1 if there is none."""
    for joint in joints:
        if model.jnt_type[joint] == kind and np.allclose(model.jnt_axis[joint], axis, atol=_SLACK):
            return joint
    return -1


def _rest(model: mujoco.MjModel, base: int, address: int) -> FloatArray:
    """Return height and rotation of a free base whose lowest geom touches the floor."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    own = model.body_rootid[model.geom_bodyid] == model.body_rootid[base]
    bottom = lowest(model, data, np.flatnonzero(own & collides(model)).tolist())
    axes = data.xmat[base].reshape(3, 3)
    yaw = math.atan2(axes[1, 0], axes[0, 0])
    back = np.array([math.cos(yaw / 2), 0.0, 0.0, -math.sin(yaw / 2)])
    quat = np.empty(4)
    mujoco.mju_mulQuat(quat, back, model.qpos0[address + 3 : address + 7])
    return np.concatenate([[model.qpos0[address + 2] - bottom], quat])
