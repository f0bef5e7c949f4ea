"""How finely a cone is sampled: replace the rays of every cone by another number of them."""

import mujoco
import numpy as np

from nomad_mj.errors import ConfigError
from nomad_mj.robots.rings import group_rays

MOST_RAYS = 64


def set_rays_per_cone(spec: mujoco.MjSpec, rays: int) -> None:
    """Give every cone of several rays `rays` of them, evenly over the same opening.

    Parameters
    ----------
    spec : mujoco.MjSpec
        A robot; changed in place. Rings of single rays stay as they are.
    rays : int
        Rays of a cone, 2 to 64.

    Raises
    ------
    ConfigError
        `rays` is out of range.
    """
    if not 2 <= rays <= MOST_RAYS:
        raise ConfigError(f"rays per cone: {rays} is not in 2 to {MOST_RAYS}")
    model = spec.compile()
    kind = mujoco.mjtSensor.mjSENS_RANGEFINDER
    sensors = [s for s in spec.sensors if s.type == kind]
    for ring, cones in group_rays([s.name for s in sensors]).items():
        for cone, members in cones.items():
            if len(members) < 2:
                continue
            old = [sensors[m] for m in members]
            _refan(spec, model, [s.name for s in old], f"{ring}_{{}}_{cone:02d}", rays)


def _refan(spec: mujoco.MjSpec, model: mujoco.MjModel, old: list[str], new: str, rays: int) -> None:
    """Replace the rays called `old` by `rays` of them over the same opening."""
    template = next(s for s in spec.sensors if s.name == old[0])
    kept = (template.cutoff, template.interval, list(template.intprm))
    first, last = (model.site(model.sensor(n).objid[0]) for n in (old[0], old[-1]))
    body = spec.body(model.body(int(first.bodyid[0])).name)
    quats = [np.array(site.quat) for site in (first, last)]
    position = np.array(first.pos)
    for name in old:
        site = next(s for s in spec.sites if s.name == model.site(model.sensor(name).objid[0]).name)
        spec.delete(next(s for s in spec.sensors if s.name == name))
        spec.delete(site)
    for ray, share in enumerate(np.linspace(0.0, 1.0, rays)):
        name = new.format(ray)
        body.add_site(name=name, pos=position, quat=_between(quats[0], quats[1], share))
        sensor = spec.add_sensor(
            name=name,
            type=mujoco.mjtSensor.mjSENS_RANGEFINDER,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            objname=name,
        )
        sensor.cutoff, sensor.interval, sensor.intprm = kept


def _between(start: np.ndarray, end: np.ndarray, share: float) -> np.ndarray:
    """Return the rotation that is `share` of the way from `start` to `end` (quaternions)."""
    velocity = np.empty(3)
    mujoco.mju_subQuat(velocity, end, start)
    result = start.copy()
    mujoco.mju_quatIntegrate(result, velocity, share)
    return result
