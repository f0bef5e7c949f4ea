"""How far a robot's geoms reach: its height, its radius, its wheels."""

from collections.abc import Iterable

import mujoco
import numpy as np
import numpy.typing as npt

from nomad_mj.types import FloatArray

_GEOM = mujoco.mjtGeom
_DIRECTIONS = np.linspace(0.0, 2 * np.pi, 72, endpoint=False)


def collides(model: mujoco.MjModel) -> npt.NDArray[np.bool_]:
    """Return which geoms meet others at all, (G,)."""
    return (model.geom_contype | model.geom_conaffinity) != 0


def reach(model: mujoco.MjModel, data: mujoco.MjData, geom: int, direction: FloatArray) -> float:
    """Return how far a geom reaches along a direction (3,) from the world's origin [m].

    Exact for everything but height fields and signed distance fields, whose box is taken.
    """
    local = direction @ data.geom_xmat[geom].reshape(3, 3)
    size, kind = model.geom_size[geom], model.geom_type[geom]
    middle = float(data.geom_xpos[geom] @ direction)
    if kind == _GEOM.mjGEOM_SPHERE:
        return middle + float(size[0])
    if kind == _GEOM.mjGEOM_CAPSULE:
        return middle + float(size[0] + size[1] * abs(local[2]))
    if kind == _GEOM.mjGEOM_ELLIPSOID:
        return middle + float(np.linalg.norm(size * local))
    if kind == _GEOM.mjGEOM_CYLINDER:
        return middle + float(size[0] * np.hypot(*local[:2]) + size[1] * abs(local[2]))
    if kind == _GEOM.mjGEOM_MESH:
        mesh = int(model.geom_dataid[geom])
        first = int(model.mesh_vertadr[mesh])
        vertices = model.mesh_vert[first : first + int(model.mesh_vertnum[mesh])]
        return middle + float((vertices @ local).max())
    box = model.geom_aabb[geom]
    return middle + float(box[:3] @ local + box[3:] @ np.abs(local))


def highest(model: mujoco.MjModel, data: mujoco.MjData, geoms: Iterable[int]) -> float:
    """Return the height of the highest point of some geoms, 0 at least [m]."""
    up = np.array([0.0, 0.0, 1.0])
    return max((reach(model, data, geom, up) for geom in geoms), default=0.0)


def lowest(model: mujoco.MjModel, data: mujoco.MjData, geoms: Iterable[int]) -> float:
    """Return the height of the lowest point of some geoms, 0 if there are none [m]."""
    down = np.array([0.0, 0.0, -1.0])
    return -max((reach(model, data, geom, down) for geom in geoms), default=0.0)


def perimeter(
    model: mujoco.MjModel, data: mujoco.MjData, geoms: Iterable[int], centre: FloatArray
) -> float:
    """Return the radius of the circle about a point (3,) that holds some geoms [m]."""
    ways = [np.array([np.cos(a), np.sin(a), 0.0]) for a in _DIRECTIONS]
    found = [reach(model, data, g, way) - float(centre @ way) for g in geoms for way in ways]
    return max(found, default=0.0)
