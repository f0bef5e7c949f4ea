"""The footprint of a MuJoCo geom: its projection on the floor, as a convex polygon."""

from collections.abc import Iterator

import mujoco
import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from nomad_mj.arenas.names import is_moving, room_name
from nomad_mj.errors import ModelError
from nomad_mj.types import FloatArray

FLOOR_HEIGHT = 0.01
"""Whatever ends below this height [m] is floor, not obstacle."""

FARTHEST = 1e5
"""What stands or reaches farther from the origin [m] is a mistake."""

ROUND_TOLERANCE = 0.001
"""How far the polygon drawn around something round may stand off from it [m]."""

_CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=np.float64)
_ENDS = np.array([[0, 0, -1], [0, 0, 1]], dtype=np.float64)
_CENTRE = np.zeros((1, 3))


def footprints(
    model: mujoco.MjModel, robot_height: float, exclude_body_prefix: str
) -> Iterator[tuple[str, BaseGeometry]]:
    """Yield name and footprint of every geom a robot of this height can run into.

    Bodies stand at their initial pose; those that the task moves are left out. The whole geom is
    projected, also what lies above the robot.

    Parameters
    ----------
    model : mujoco.MjModel
        A compiled room, with or without a robot in it.
    robot_height : float
        Geoms that begin above it [m] are no obstacle.
    exclude_body_prefix : str
        Geoms below a body whose name begins so are left out (the robot itself).

    Raises
    ------
    ModelError
        For a height field, a plane that is not level, or what is beyond all measure.
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    excluded = _excluded_bodies(model, exclude_body_prefix)
    for geom in range(model.ngeom):
        collides = model.geom_contype[geom] | model.geom_conaffinity[geom]
        if not collides or excluded[model.geom_bodyid[geom]]:
            continue
        name = room_name(model.geom(geom).name) or f"geom {geom}"
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_PLANE:
            _check_level(data.geom_xmat[geom], name)
            continue
        points, spread = _points_and_spread(model, data, geom, name)
        if not (np.abs(points).max() < FARTHEST and np.abs(spread).max() < FARTHEST):
            raise ModelError(
                f"{name!r} reaches farther than {FARTHEST:g} m from the origin; lengths are metres"
            )
        reach = float(np.linalg.norm(spread[2]))
        bottom, top = points[:, 2].min() - reach, points[:, 2].max() + reach
        if bottom < robot_height and top > FLOOR_HEIGHT:
            yield name, _project(points[:, :2], spread[:2])


def reach(model: mujoco.MjModel, data: mujoco.MjData, geom: int, centre: FloatArray) -> float:
    """Return the radius of the upright cylinder around a place (2 or 3,) that holds a geom [m]."""
    name = room_name(model.geom(geom).name) or f"geom {geom}"
    points, spread = _points_and_spread(model, data, geom, name)
    outline = shapely.get_coordinates(_project(points[:, :2] - centre[:2], spread[:2]))
    if spread.any() and not np.ptp(points[:, :2], axis=0).any():  # exact for what is round
        thick = float(np.linalg.norm(spread[:2], ord=2))
        return float(np.hypot(*(points[0, :2] - centre[:2]))) + thick
    return float(np.hypot(*outline.T).max())


def _excluded_bodies(model: mujoco.MjModel, prefix: str) -> list[bool]:
    excluded: list[bool] = []
    for body in range(model.nbody):  # parents come before their children
        inherited = body > 0 and excluded[int(model.body_parentid[body])]
        named = model.body(body).name.startswith(prefix)
        excluded.append(inherited or named or is_moving(model, body))
    return excluded


def _check_level(rotation: FloatArray, name: str) -> None:
    if rotation[8] < 1 - 1e-6:
        raise ModelError(
            f"{name!r} is a plane that is not level; a plane can only be the floor: "
            "make walls of boxes"
        )


def _points_and_spread(
    model: mujoco.MjModel, data: mujoco.MjData, geom: int, name: str
) -> tuple[FloatArray, FloatArray]:
    """Write a geom as the hull of points (K, 3), each thickened by a linear image of the unit ball.

    The image is given by a matrix (3, 3): all zero for a box, a radius times a rotation for a
    capsule, two columns of it for a cylinder.
    """
    kinds = mujoco.mjtGeom
    kind = kinds(int(model.geom_type[geom]))
    size = np.asarray(model.geom_size[geom], dtype=np.float64)
    rotation = np.asarray(data.geom_xmat[geom], dtype=np.float64).reshape(3, 3)
    if kind == kinds.mjGEOM_BOX:
        local, spread = _CUBE * size, np.zeros(3)
    elif kind == kinds.mjGEOM_SPHERE:
        local, spread = _CENTRE, np.full(3, size[0])
    elif kind == kinds.mjGEOM_ELLIPSOID:
        local, spread = _CENTRE, size
    elif kind == kinds.mjGEOM_CAPSULE:
        local, spread = _ENDS * size[1], np.full(3, size[0])
    elif kind == kinds.mjGEOM_CYLINDER:
        local, spread = _ENDS * size[1], np.array([size[0], size[0], 0.0])
    elif kind in (kinds.mjGEOM_MESH, kinds.mjGEOM_SDF):
        mesh = int(model.geom_dataid[geom])
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        local = np.asarray(model.mesh_vert[first : first + count], dtype=np.float64)
        spread = np.zeros(3)
    else:
        raise ModelError(
            f"{name!r} is a {kind.name.removeprefix('mjGEOM_').lower()}, which has no footprint; "
            "use boxes, cylinders, capsules, spheres, ellipsoids or meshes"
        )
    with np.errstate(invalid="ignore", over="ignore"):  # whoever needs it looks at what comes out
        return local @ rotation.T + data.geom_xpos[geom], rotation * spread


def _project(points: FloatArray, spread: FloatArray) -> BaseGeometry:
    """Hull of points (K, 2), each with the ellipse ``spread @ unit ball`` (2, 3) around it."""
    if spread.any():
        values, vectors = np.linalg.eigh(spread @ spread.T)
        axes = vectors * np.sqrt(np.maximum(values, 0.0))
        outline = _unit_circle(float(np.sqrt(values[-1]))) @ axes.T
        points = (points[:, None] + outline).reshape(-1, 2)
    hull = shapely.MultiPoint(points).convex_hull
    return hull if hull.area else hull.buffer(1e-6)  # a flat mesh on edge: still a polygon


def _unit_circle(scale: float) -> FloatArray:
    """Corners (N, 2) of a polygon around the unit circle, within tolerance once scaled."""
    half_angle = np.arccos(scale / (scale + ROUND_TOLERANCE))
    count = max(8, int(np.ceil(np.pi / half_angle)))
    angles = 2 * np.pi * np.arange(count) / count
    return np.stack([np.cos(angles), np.sin(angles)], axis=-1) / np.cos(np.pi / count)
