"""Edit a room before it is compiled: its goal elsewhere or on a body, and obstacles that move."""

from collections.abc import Sequence

import mujoco
import numpy as np

from nomad_mj.arenas.names import MOVING
from nomad_mj.errors import ConfigError
from nomad_mj.movers.drift import MovingObstacles
from nomad_mj.movers.stroll import Walkers

_LOOK = (0.55, 0.47, 0.66, 1.0)  # none of the rooms' own colours
_HEAD = (0.93, 0.80, 0.70, 1.0)
_SHOULDER = 0.85  # of a figure's height


def place_goal(spec: mujoco.MjSpec, goal: Sequence[float] | None, moving: bool) -> None:
    """Put the goal of a room elsewhere, or on a body that can move.

    Parameters
    ----------
    spec : mujoco.MjSpec
        The room; changed in place.
    goal : (float, float) or None
        Where [m, world frame]; None for where it is.
    moving : bool
        Whether it must be on a mocap body.

    Raises
    ------
    ConfigError
        A goal that is no place.
    """
    place = None if goal is None else _place(goal)
    site = spec.site("goal")
    if site is None:
        return  # for `Arena.from_model` to complain about
    model = spec.copy().compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    index = model.site("goal").id
    was: np.ndarray = data.site_xpos[index]
    to = was if place is None else np.array([*place, was[2]])
    body = int(model.body_rootid[model.site_bodyid[index]])
    if model.body_mocapid[body] >= 0:
        _shift(spec, _root(site.parent), data.xpos[body] + (to - was), data.xquat[body])
    else:
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, data.site_xmat[index])
        _replace(spec, site, to, quat, moving)


def _place(goal: Sequence[float]) -> list[float]:
    try:
        place = np.asarray(goal, dtype=np.float64)
    except (TypeError, ValueError):  # not numbers, or not as many in every row
        place = np.array(np.nan)
    if place.shape != (2,) or not np.isfinite(place).all():
        given = " ".join(str(goal).split())
        raise ConfigError(f"goal {given}: must be (x, y) in metres")
    return place.tolist()


def _root(body: mujoco.MjsBody) -> mujoco.MjsBody:
    """Return the body of the world that a body is on."""
    while body.parent.name != "world":
        body = body.parent
    return body


def _shift(spec: mujoco.MjSpec, body: mujoco.MjsBody, pos: np.ndarray, quat: np.ndarray) -> None:
    """Put a body of the world at a pose of the world, whatever frames it was in."""
    body.set_frame(spec.worldbody.add_frame())
    body.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
    body.pos, body.quat = pos, quat


def _replace(
    spec: mujoco.MjSpec, old: mujoco.MjsSite, pos: np.ndarray, quat: np.ndarray, moving: bool
) -> None:
    """Put a site like the old one into the world or on a mocap body, at a pose of the world."""
    look = {key: getattr(old, key) for key in ("type", "material", "group")}
    look |= {key: np.array(getattr(old, key)) for key in ("size", "rgba")}
    spec.delete(old)
    parent = spec.worldbody
    if moving:
        parent = spec.worldbody.add_body(name=_free_name(spec, f"{MOVING}_goal"), mocap=True)
        parent.pos, pos = pos, np.zeros(3)
    parent.add_site(name="goal", pos=pos, quat=quat, **look)


def add_obstacles(spec: mujoco.MjSpec, config: MovingObstacles) -> tuple[str, ...]:
    """Add moving cylinders, or figures that walk, to a room; return the names of their bodies."""
    look = _look(spec, f"{MOVING}_look", _LOOK)
    head = _look(spec, f"{MOVING}_head", _HEAD) if isinstance(config, Walkers) else ""
    names: list[str] = []
    turn = config.direction / 2
    for number in range(config.count):
        name = _free_name(spec, f"{MOVING}_{number}")
        body = spec.worldbody.add_body(
            name=name, mocap=True, quat=[np.cos(turn), 0.0, 0.0, np.sin(turn)]
        )
        tall = config.height * (_SHOULDER if head else 1.0)
        body.pos = [0.0, 0.0, tall / 2]
        body.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_CYLINDER,
            size=[config.radius, tall / 2, 0.0],
            material=look,
            contype=1,
            conaffinity=1,
        )
        if head:
            half = (config.height - tall) / 2
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_ELLIPSOID,
                size=[0.5 * config.radius, 0.5 * config.radius, half],
                pos=[0.0, 0.0, tall / 2 + half],
                material=head,
                contype=0,
                conaffinity=0,
            )
        names.append(name)
    return tuple(names)


def _look(spec: mujoco.MjSpec, name: str, colour: tuple[float, ...]) -> str:
    """Add a material of a colour; return its name."""
    look = spec.add_material(name=_free_name(spec, name), rgba=colour)
    look.specular = look.shininess = 0.1
    return look.name


def _free_name(spec: mujoco.MjSpec, wanted: str) -> str:
    taken = {each.name for each in (*spec.bodies, *spec.geoms, *spec.materials)}
    while wanted in taken:
        wanted += "_"
    return wanted
