"""Rays that tell, beside how far a surface is, how it lies: what specular reflection depends on.

Such a ray puts seven numbers into ``sensordata``: distance [m], its direction and the surface's
normal, both unit vectors of the world. Where it hits nothing they are -1 and zeros.
"""

from collections.abc import Iterable

import mujoco

from nomad_mj.errors import ConfigError
from nomad_mj.robots.rings import SURFACE_DATA, group_rays, reporting_surfaces


def report_surfaces(spec: mujoco.MjSpec, rings: Iterable[str]) -> None:
    """Let the rays of some rings report the surfaces that they strike.

    Parameters
    ----------
    spec : mujoco.MjSpec
        A robot; changed in place.
    rings : iterable of str
        Names of rings.

    Raises
    ------
    ConfigError
        The robot has no such ring.
    """
    sensors = [s for s in spec.sensors if s.type == mujoco.mjtSensor.mjSENS_RANGEFINDER]
    found = group_rays([s.name for s in sensors])
    for ring in rings:
        if ring not in found:
            raise ConfigError(
                f"specular ring {ring!r}: the robot has no such ring; "
                f"rings it has: {', '.join(found) or 'none'}"
            )
        for cone in found[ring].values():
            for ray in cone:
                sensors[ray].intprm = [SURFACE_DATA, 0, 0]


def unclip_surfaces(model: mujoco.MjModel) -> None:
    """Take the cutoff off the rays that report surfaces: the engine clips all seven numbers to it.

    The range sensors' limits must have been read before.
    """
    model.sensor_cutoff[reporting_surfaces(model)] = 0.0
