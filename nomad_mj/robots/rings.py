"""Range sensors found by name and type: rays make cones, cones make rings.

A rangefinder is called ``<ring>_<ray>_<cone>`` or, with one ray a cone, ``<ring>_<cone>``: the
names that nested ``<replicate>`` elements give.
"""

import re
from collections import defaultdict
from collections.abc import Callable
from typing import NamedTuple

import mujoco
import numpy as np

from nomad_mj.errors import ModelError
from nomad_mj.types import FloatArray, IntArray, RangeRing

PREFIX = "robot/"  # of everything that belongs to the robot in a compiled scene
_FIELD = mujoco.mjtRayDataField
# What a ray reports that tells how a surface lies; an ordinary one reports the distance alone.
SURFACE_DATA = sum(
    1 << int(field)
    for field in (_FIELD.mjRAYDATA_DIST, _FIELD.mjRAYDATA_DIR, _FIELD.mjRAYDATA_NORMAL)
)
_NAME = re.compile(r"(?P<ring>.*?)(?:_(?P<ray>\d+))?_(?P<cone>\d+)")


class RayIndex(NamedTuple):
    """Where the rays are in ``sensordata``; R rays in C cones, rings one after another.

    Attributes
    ----------
    address : array (R,)
        Place in ``sensordata`` of each ray, cone by cone.
    first : array (C,)
        Index into `address` of each cone's first ray.
    offset : array (C,)
        From a cone's site to the robot's perimeter [m]; negative where the site is outside.
    minimum, maximum : array (C,)
        Limits of the readings [m].
    specular : array (S,)
        Indices into `address` of the rays that report the surfaces they strike; empty unless the
        scene was built with `specular_rings`.
    """

    address: IntArray
    first: IntArray
    offset: FloatArray
    minimum: FloatArray
    maximum: FloatArray
    specular: IntArray


def group_rays(names: list[str]) -> dict[str, dict[int, list[int]]]:
    """Return ``{ring: {cone: [position in names]}}``, rays and cones in order of their numbers."""
    found: dict[str, dict[int, list[tuple[int, int]]]] = defaultdict(lambda: defaultdict(list))
    for position, name in enumerate(names):
        match = _NAME.fullmatch(name.rpartition("/")[2])
        if match:
            ray = int(match["ray"] or 0)
            found[match["ring"]][int(match["cone"])].append((ray, position))
    return {
        ring: {cone: [p for _, p in sorted(cones[cone])] for cone in sorted(cones)}
        for ring, cones in found.items()
    }


def _ray_direction(model: mujoco.MjModel, site: int) -> float:
    """Return the bearing of a site's z axis in its body's frame [rad]."""
    axis = np.empty(3)
    mujoco.mju_rotVecQuat(axis, np.array([0.0, 0.0, 1.0]), model.site_quat[site])
    return float(np.arctan2(axis[1], axis[0]))


def _ring(
    model: mujoco.MjModel, name: str, cones: dict[int, list[int]], minimum: float
) -> RangeRing:
    """Return the ring whose cones hold these sensors."""
    bearings: list[float] = []
    spread = 0.0
    for sensors in cones.values():
        angles = np.array([_ray_direction(model, int(model.sensor_objid[s])) for s in sensors])
        axis = float(np.angle(np.exp(1j * angles).sum()))
        bearings.append(axis)
        spread = max(spread, float(np.abs(np.angle(np.exp(1j * (angles - axis)))).max()))
    cutoff = float(model.sensor_cutoff[next(iter(cones.values()))[0]])
    if spread < 1e-6:  # single rays, but for rounding: each speaks for the space up to the next
        around = np.sort(bearings)
        gaps = np.diff(around, append=around[0] + 2 * np.pi)
        spread = float(max(gaps.min() / 2, 1e-3)) if len(bearings) > 1 else np.pi / 12
    return RangeRing(name, tuple(bearings), spread, minimum, cutoff if cutoff > 0 else 10.0)


def reporting_surfaces(model: mujoco.MjModel) -> IntArray:
    """Return the indices of the rangefinders that report the surfaces they strike."""
    rangefinder = model.sensor_type == mujoco.mjtSensor.mjSENS_RANGEFINDER
    return np.flatnonzero(rangefinder & (model.sensor_intprm[:, 0] == SURFACE_DATA))


def index_rays(
    model: mujoco.MjModel, robot: str, radius: float, number: Callable[[str], float]
) -> tuple[RayIndex, tuple[RangeRing, ...]]:
    """Return where the rays are, and the rings they make.

    Parameters
    ----------
    model, robot
        The compiled model and the robot's name, for messages.
    radius : float
        Of the robot's perimeter [m].
    number : callable
        Gives the robot's custom number of a name, such as ``sonar_min_range``, 0 where it has none.

    Raises
    ------
    ModelError
        The robot has no range sensor with a name of the form ``<ring>_<ray>_<cone>``, or one that
        does not turn with the turret.
    """
    found = np.flatnonzero(model.sensor_type == mujoco.mjtSensor.mjSENS_RANGEFINDER)
    sensors = [int(i) for i in found if model.sensor(int(i)).name.startswith(PREFIX)]
    names = [model.sensor(i).name.removeprefix(PREFIX) for i in sensors]
    address: list[int] = []
    first: list[int] = []
    rows: list[tuple[float, float, float]] = []
    rings: list[RangeRing] = []
    turret = int(model.joint(PREFIX + "turret").bodyid[0])
    for ring_name, cones in group_rays(names).items():
        cones = {cone: [sensors[p] for p in rays] for cone, rays in cones.items()}
        ring = _ring(model, ring_name, cones, number(f"{ring_name}_min_range"))
        if ring.min_range >= ring.max_range:
            raise ModelError(
                f"robot {robot!r}: {ring_name}_min_range {ring.min_range:g} m must be below the "
                f"cutoff of its rangefinders, {ring.max_range:g} m"
            )
        rings.append(ring)
        for rays in cones.values():
            if any(model.site_bodyid[model.sensor_objid[s]] != turret for s in rays):
                raise ModelError(
                    f"robot {robot!r}: the sites of {ring_name!r} must be in the body of the joint "
                    "'turret', from whose angle their bearings are counted"
                )
            first.append(len(address))
            address.extend(int(model.sensor_adr[s]) for s in rays)
            site = model.site_pos[int(model.sensor_objid[rays[0]])]
            rows.append((radius - float(np.hypot(*site[:2])), ring.min_range, ring.max_range))
    if not rings:
        raise ModelError(
            f"robot {robot!r} has no range sensor: add rangefinders named <ring>_<ray>_<cone>, "
            f"such as sonar_0_0; rangefinders it has: {', '.join(names) or 'none'}"
        )
    offset, minimum, maximum = np.array(rows).T
    specular = np.flatnonzero(np.isin(address, model.sensor_adr[reporting_surfaces(model)]))
    rays = RayIndex(np.array(address), np.array(first), offset, minimum, maximum, specular)
    return rays, tuple(rings)
