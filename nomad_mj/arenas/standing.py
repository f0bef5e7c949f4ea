"""What of a room stands still, and how much of it can be near a place."""

import mujoco
import numpy as np
import numpy.typing as npt
import shapely

from nomad_mj.types import FloatArray, IntArray

_LATTICE = 1.0  # [m] between the places looked at
_MOST_STEPS = 100  # of the lattice, along a side
_TYPES = (
    mujoco.mjtGeom.mjGEOM_SPHERE,
    mujoco.mjtGeom.mjGEOM_CAPSULE,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_MESH,
)


def standing(model: mujoco.MjModel) -> IntArray:
    """Return the geoms that stand still, have an end, and that nothing names, (N,), ascending."""
    fixed = (model.body_weldid == 0) & (model.body_mocapid[model.body_rootid] < 0)
    found = fixed[model.geom_bodyid] & np.isin(model.geom_type, _TYPES) & ~_named(model)
    return np.flatnonzero(found)


def _named(model: mujoco.MjModel) -> npt.NDArray[np.bool_]:
    """Whether pairs, sensors, tendons, tuples or exclusions look at a geom or its body, (G,)."""
    kinds = mujoco.mjtObj
    wrapped = (mujoco.mjtWrap.mjWRAP_SPHERE, mujoco.mjtWrap.mjWRAP_CYLINDER)
    named = np.zeros(model.ngeom, dtype=np.bool_)
    for geoms in (
        model.pair_geom1,
        model.pair_geom2,
        model.sensor_objid[model.sensor_objtype == kinds.mjOBJ_GEOM],
        model.sensor_refid[model.sensor_reftype == kinds.mjOBJ_GEOM],
        model.wrap_objid[np.isin(model.wrap_type, wrapped)],
        model.tuple_objid[model.tuple_objtype == kinds.mjOBJ_GEOM],
    ):
        named[geoms] = True
    bodies = (kinds.mjOBJ_BODY, kinds.mjOBJ_XBODY)
    of_bodies = [
        model.sensor_objid[np.isin(model.sensor_objtype, bodies)],
        model.sensor_refid[np.isin(model.sensor_reftype, bodies)],
    ]
    named |= np.isin(model.geom_bodyid, np.concatenate(of_bodies))
    if model.nexclude:  # what is excluded is so for the world's own geoms, wherever they are held
        named |= model.geom_bodyid != 0
    return named


def rectangles(model: mujoco.MjModel, geoms: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return middle and half sides, (N, 2) [m], of rectangles around geoms that stand."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    rotation = data.geom_xmat[geoms].reshape(-1, 3, 3)[:, :2]
    local, half = model.geom_aabb[geoms, :3], model.geom_aabb[geoms, 3:]
    middle = data.geom_xpos[geoms, :2] + np.einsum("nij,nj->ni", rotation, local)
    return middle, np.einsum("nij,nj->ni", np.abs(rotation), half)


def most_near(middle: FloatArray, half: FloatArray, reach: float) -> int:
    """Return how many of some rectangles can be within reach [m] of one place, at most.

    Counted on a lattice, with so much more reach that the places between count too. A place
    outside of all has no more around it than the nearest one of their bounds.
    """
    low, high = (middle - half).min(axis=0), (middle + half).max(axis=0)
    steps = np.clip(np.ceil((high - low) / _LATTICE), 1, _MOST_STEPS).astype(int)
    x, y = (np.linspace(low[axis], high[axis], steps[axis] + 1) for axis in (0, 1))
    between = float(np.hypot(*((high - low) / steps))) / 2
    tree = shapely.STRtree(shapely.box(*(middle - half).T, *(middle + half).T))
    places = shapely.points(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
    found = tree.query(places, predicate="dwithin", distance=reach + between + 1e-6)
    return int(np.bincount(found[0]).max())
