"""What spoils learning with a robot and is no error of its file."""

import math

import mujoco
import numpy as np
from dm_control.rl.control import PhysicsError

from nomad_mj.motion import SynchroDrive
from nomad_mj.robots import PREFIX, solid_radius
from nomad_mj.scene import CONTROL_TIMESTEP, Scene
from nomad_mj.tasks import NavigationPhysics
from nomad_mj.types import Pose

_MOVE = 1.0  # [m], the longest
_LEVEL = math.radians(5)
_SEAM = math.radians(3)  # between cones that still count as closed
_BEYOND = 0.01  # [m] that geoms may reach beyond the perimeter
_REST = 2.0  # [s] for which the robot should stand still
_STILL, _UPRIGHT = 0.002, math.radians(1)  # [m], [rad]


def find_faults(scene: Scene) -> list[str]:
    """Return what a user should know of a robot, one line each, with what would be better.

    Parameters
    ----------
    scene : Scene
        The robot in a room with some metres of free floor about its first start.
    """
    faults = [*_size(scene), *_reach(scene), *_gaps(scene), *_rays(scene), *_rest(scene)]
    if not scene.robot.bumpers:
        faults.append(
            "no bumpers: contacts are not felt, a move that pushes something ends by its time "
            "limit; add touch sensors"
        )
    return faults


def _size(scene: Scene) -> list[str]:
    """Return a line if what collides reaches beyond the perimeter."""
    radius = scene.robot.layout.radius
    beyond = solid_radius(scene.model, scene.robot.footing) - radius
    if beyond < _BEYOND:
        return []
    fault = (
        f"its radius is {radius:g} m, but what collides reaches {beyond:.2f} m farther; without "
        "the number it is measured"
    )
    return [fault]


def _reach(scene: Scene) -> list[str]:
    farthest = max(ring.max_range for ring in scene.robot.layout.rings)
    if farthest >= _MOVE + 0.2:
        return []
    fault = (
        f"range sensors see {farthest:g} m, moves are up to {_MOVE:g} m long: the robot drives "
        "where it has not looked; raise the cutoff"
    )
    return [fault]


def _gaps(scene: Scene) -> list[str]:
    """Return a line for the widest gap between cones, if there is one."""
    cones = sorted(
        (bearing % (2 * math.pi), ring.half_angle)
        for ring in scene.robot.layout.rings
        for bearing in ring.bearings
    )
    covered = np.zeros(720, dtype=bool)
    middles = np.arange(720) * math.pi / 360
    for bearing, half in cones:
        off = np.abs((middles - bearing + math.pi) % (2 * math.pi) - math.pi)
        covered |= off <= half + _SEAM
    share = 1 - covered.mean()
    if share < 0.02:
        return []
    blind = np.degrees(middles[~covered])
    fault = (
        f"no cone covers {share:.0%} of the directions (such as {blind[len(blind) // 2]:.0f} deg): "
        "these count as half occupied; open the cones, add some, or spread single rays evenly"
    )
    return [fault]


def _rays(scene: Scene) -> list[str]:
    """Return lines for rays that see the robot itself or do not lie level."""
    model, faults = scene.model, list[str]()
    data = mujoco.MjData(model)
    scene.robot.footing.place(data.qpos, Pose(*scene.arena.starts[0].tolist()))
    mujoco.mj_forward(model, data)
    own, tilted = list[str](), list[str]()
    kind = mujoco.mjtSensor.mjSENS_RANGEFINDER
    hit = np.zeros(1, dtype=np.int32)
    for sensor in np.flatnonzero(model.sensor_type == kind).tolist():
        name = model.sensor(sensor).name.removeprefix(PREFIX)
        site = int(model.sensor_objid[sensor])
        ray = data.site_xmat[site].reshape(3, 3)[:, 2]
        body = int(model.site_bodyid[site])
        mujoco.mj_ray(model, data, data.site_xpos[site], ray, None, 1, body, hit)
        if hit[0] >= 0 and model.body(model.geom_bodyid[hit[0]]).name.startswith(PREFIX):
            own.append(f"{name} ({model.geom(hit[0]).name.removeprefix(PREFIX) or 'a geom'})")
        if abs(ray[2]) > math.sin(_LEVEL):
            tilted.append(name)
    if own:
        faults.append(
            f"{len(own)} rays see the robot itself, such as {own[0]}: put their sites outside it"
        )
    if tilted:
        faults.append(
            f"{len(tilted)} rays are not level, such as {tilted[0]}: they meet the floor or pass "
            "over obstacles"
        )
    return faults


def _rest(scene: Scene) -> list[str]:
    """Return a line if the robot does not stand still when it is told to."""
    physics = NavigationPhysics.from_scene(scene)
    try:
        start = Pose(*scene.arena.starts[0].tolist())
        with physics.reset_context():
            physics.place(start)
        data, base = physics.data.ptr, scene.robot.footing.base
        tick = round(CONTROL_TIMESTEP / float(scene.model.opt.timestep))
        physics.step(10 * tick)  # time to settle
        before, height = physics.pose(), float(data.xpos[base][2])
        physics.step(round(_REST / CONTROL_TIMESTEP) * tick)
        after = physics.pose()
        moved = math.hypot(after.x - before.x, after.y - before.y, data.xpos[base][2] - height)
        tilt = math.acos(min(1.0, float(data.xmat[base].reshape(3, 3)[2, 2])))
        off = math.hypot(before.x - start.x, before.y - start.y)
    except PhysicsError as error:
        return [
            f"does not stand still: {error}; look for geoms that overlap, tiny masses, stiff servos"
        ]
    finally:
        physics.free()
    faults: list[str] = []
    if max(moved, off) > _STILL:
        faults.append(
            f"does not stand still: {1000 * max(moved, off):.0f} mm in {_REST:g} s without a "
            "command; look for geoms that overlap, or soften its servos"
        )
    if tilt > _UPRIGHT and not isinstance(scene.robot.drive, SynchroDrive):
        faults.append(
            f"stands {math.degrees(tilt):.0f} deg askew: its wheels and castors do not reach the "
            "floor alike"
        )
    return faults
