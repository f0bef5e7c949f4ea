"""What spoils driving in a room and is no error of its file."""

import mujoco
import numpy as np
import shapely

from nomad_mj.arenas.names import room_name
from nomad_mj.robots import PREFIX, reach
from nomad_mj.scene import Scene
from nomad_mj.types import Pose

_UP = np.array([0.0, 0.0, 1.0])


def find_room_faults(scene: Scene) -> list[str]:
    """Return what a user should know of a room, one line each, with what would be better."""
    return [*_low(scene), *_open(scene)]


def _low(scene: Scene) -> list[str]:
    """Return a line if something that stands is below all rays of the robot."""
    model = scene.model
    data = mujoco.MjData(model)
    scene.robot.footing.place(data.qpos, Pose(*scene.arena.starts[0].tolist()))
    mujoco.mj_kinematics(model, data)
    kind = mujoco.mjtSensor.mjSENS_RANGEFINDER
    rays = [s for s in np.flatnonzero(model.sensor_type == kind).tolist() if _is_own(model, s)]
    lowest = float(data.site_xpos[model.sensor_objid[rays], 2].min())
    low = [
        name
        for geom in range(model.ngeom)
        if (name := room_name(model.geom(geom).name) or f"geom {geom}") in scene.plan.names
        and reach(model, data, geom, _UP) < lowest
    ]
    if not low:
        return []
    named = ", ".join(low[:3]) + (", ..." if len(low) > 3 else "")
    fault = (
        f"{named}: lower than {lowest:.2f} m, where the range sensors of {scene.robot.name} look "
        "out: they do not see it; make it higher"
    )
    return [fault]


def _is_own(model: mujoco.MjModel, sensor: int) -> bool:
    return model.sensor(sensor).name.startswith(PREFIX)


def _open(scene: Scene) -> list[str]:
    """Return a line if the robot can leave the room, unless it is an open floor."""
    if not scene.plan.footprints:
        return []
    x0, y0, x1, y1 = scene.plan.bounds.tolist()
    if shapely.box(x0, y0, x1, y1).buffer(1e-6).contains(scene.free_space):
        return []
    return ["nothing keeps the robot in: there is a gap in the walls, or no wall; add one"]
