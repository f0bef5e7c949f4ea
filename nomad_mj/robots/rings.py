"""Range sensors found by name and type: rays make cones, cones make rings.

A rangefinder is called ``<ring>_<ray>_<cone>`` or, with one ray a cone, ``<ring>_<cone>``: the
names that nested ``<replicate>`` elements give.
"""

import re
from collections import defaultdict
from typing import NamedTuple

import mujoco
import numpy as np

from nomad_mj.robots.naming import PREFIX, NamedModel
from nomad_mj.types import FloatArray, IntArray, RangeRing

_SAME = 2e-3  # [rad] rays one above the other look the same way
_FARTHEST = 10.0  # [m], where a rangefinder has no cutoff
_FIELD = mujoco.mjtRayDataField
# What a ray reports that tells how a surface lies; an ordinary one reports the distance alone.
SURFACE_DATA = sum(
    1 << int(field)
    for field in (_FIELD.mjRAYDATA_DIST, _FIELD.mjRAYDATA_DIR, _FIELD.mjRAYDATA_NORMAL)
)
TAKEN = (
    *("bumpers", "encoders", "odometry", "goal"),
    *("duration", "driven", "clearance", "outcome", "contact"),
)
"""Names of other observations, which no ring can have."""
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
        match = _NAME.fullmatch(name.removeprefix(PREFIX))
        if match:
            ray = int(match["ray"] or 0)
            found[match["ring"]][int(match["cone"])].append((ray, position))
    return {
        ring: {cone: [p for _, p in sorted(cones[cone])] for cone in sorted(cones)}
        for ring, cones in found.items()
    }


class _Ray(NamedTuple):
    """Where a ray begins, (x, y) [m], and its bearing [rad], in the frame of the sensors."""

    start: FloatArray
    bearing: float


def _rays(model: mujoco.MjModel, mount: int, sites: list[int]) -> list[_Ray]:
    """Return the rays of some sites in the frame of the body `mount`."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    frame, origin = data.xmat[mount].reshape(3, 3), data.xpos[mount]
    rays: list[_Ray] = []
    for site in sites:
        start, axis = model.site_pos[site], np.empty(3)
        mujoco.mju_rotVecQuat(axis, np.array([0.0, 0.0, 1.0]), model.site_quat[site])
        if model.site_bodyid[site] != mount:
            start = (data.site_xpos[site] - origin) @ frame
            axis = data.site_xmat[site].reshape(3, 3)[:, 2] @ frame
        rays.append(_Ray(start[:2], float(np.arctan2(axis[1], axis[0]))))
    return rays


def _ring(name: str, cones: list[list[_Ray]], limits: tuple[float, float]) -> RangeRing:
    """Return the ring of these cones, with the limits of its readings [m]."""
    bearings: list[float] = []
    spread = 0.0
    for rays in cones:
        angles = np.array([ray.bearing for ray in rays])
        axis = float(np.angle(np.exp(1j * angles).sum()))
        bearings.append(axis)
        spread = max(spread, float(np.abs(np.angle(np.exp(1j * (angles - axis)))).max()))
    if spread < 1e-6:  # single rays, but for rounding: each speaks for half the least gap
        around = np.sort(bearings)
        gaps = np.diff(around, append=around[0] + 2 * np.pi)
        gaps = gaps[gaps > _SAME]
        spread = float(gaps.min() / 2) if len(gaps) > 1 else np.pi / 12
    return RangeRing(name, tuple(bearings), spread, *limits)


def _outward(ray: _Ray, axis: float) -> float:
    """Return how far out along its cone's axis a ray begins [m]."""
    distance = float(np.hypot(*ray.start))
    along = float(ray.start @ (np.cos(axis), np.sin(axis)))
    return distance if np.isclose(along, distance, atol=1e-6) else along


def reporting_surfaces(model: mujoco.MjModel) -> IntArray:
    """Return the indices of the rangefinders that report the surfaces they strike."""
    rangefinder = model.sensor_type == mujoco.mjtSensor.mjSENS_RANGEFINDER
    return np.flatnonzero(rangefinder & (model.sensor_intprm[:, 0] == SURFACE_DATA))


def _check_name(named: NamedModel, ring: str) -> None:
    if ring in TAKEN:
        raise named.error(
            f": rangefinders of a ring {ring!r} would hide another observation of that name; call "
            "them sonar_0, sonar_1, ..."
        )


def _check_mount(named: NamedModel, ring: str, sites: list[int], mount: int) -> None:
    model = named.model
    bodies = model.site_bodyid[sites]
    if (model.body_weldid[bodies] != model.body_weldid[mount]).any():
        name = mujoco.mj_id2name(model, mujoco.mjtObj.mjOBJ_BODY, mount)
        raise named.error(
            f": the sites of {ring!r} must be in the body {name.removeprefix(PREFIX)!r}, or fixed "
            "to it: their bearings count from its direction"
        )


def index_rays(
    named: NamedModel, radius: float, mount: int
) -> tuple[RayIndex, tuple[RangeRing, ...]]:
    """Return where the rays are, and the rings they make.

    Parameters
    ----------
    named : NamedModel
        The robot.
    radius : float
        Of the robot's perimeter [m].
    mount : int
        Body that the range sensors are fixed to.

    Raises
    ------
    ModelError
        The robot has no range sensor with a name of the form ``<ring>_<ray>_<cone>``, or one that
        does not turn with the mount.
    """
    model = named.model
    on_site = model.sensor_objtype == mujoco.mjtObj.mjOBJ_SITE
    rangefinder = model.sensor_type == mujoco.mjtSensor.mjSENS_RANGEFINDER
    found = np.flatnonzero(rangefinder & on_site).tolist()
    sensors = [i for i in found if model.sensor(i).name.startswith(PREFIX)]
    names = [model.sensor(i).name.removeprefix(PREFIX) for i in sensors]
    address: list[int] = []
    first: list[int] = []
    rows: list[tuple[float, float, float]] = []
    rings: list[RangeRing] = []
    for ring_name, cones in group_rays(names).items():
        members = [[sensors[p] for p in rays] for rays in cones.values()]
        sites = [[int(model.sensor_objid[s]) for s in rays] for rays in members]
        _check_name(named, ring_name)
        _check_mount(named, ring_name, [site for own in sites for site in own], mount)
        _check_cutoffs(named, [sensor for own in members for sensor in own])
        rays = [_rays(model, mount, own) for own in sites]
        ring = _ring(ring_name, rays, _limits(named, ring_name, members[0][0]))
        rings.append(ring)
        for sensors_of_cone, own, axis in zip(members, rays, ring.bearings, strict=True):
            first.append(len(address))
            address.extend(int(model.sensor_adr[s]) for s in sensors_of_cone)
            rows.append((radius - _outward(own[0], axis), ring.min_range, ring.max_range))
    if not rings:
        raise named.error(
            " has no range sensor: add rangefinders named <ring>_<ray>_<cone>, such as sonar_0_0, "
            f"or a ring in its data sheet; rangefinders it has: {', '.join(names) or 'none'}"
        )
    offset, minimum, maximum = np.array(rows).T
    specular = np.flatnonzero(np.isin(address, model.sensor_adr[reporting_surfaces(model)]))
    index = RayIndex(np.array(address), np.array(first), offset, minimum, maximum, specular)
    return index, tuple(rings)


def _check_cutoffs(named: NamedModel, sensors: list[int]) -> None:
    """Raise ModelError if rangefinders of a ring do not reach equally far."""
    cutoffs = named.model.sensor_cutoff[sensors]
    odd = np.flatnonzero(cutoffs != cutoffs[0])
    if len(odd):
        name = named.model.sensor(sensors[odd[0]]).name.removeprefix(PREFIX)
        raise named.error(
            f": rangefinder {name!r} has a cutoff of {cutoffs[odd[0]]:g} m, others of its ring "
            f"{cutoffs[0]:g} m; give it the same, or a ring of its own"
        )


def _limits(named: NamedModel, ring: str, sensor: int) -> tuple[float, float]:
    """Return the least and the greatest reading of a ring [m]."""
    cutoff = float(named.model.sensor_cutoff[sensor])
    least, most = named.number(f"{ring}_min_range", 0.0), cutoff if cutoff > 0 else _FARTHEST
    if least >= most:
        raise named.error(
            f": {ring}_min_range {least:g} m must be below the cutoff of its rangefinders, "
            f"{most:g} m"
        )
    return least, most
