"""The moving bodies of a compiled scene: which they are, how large, and how they move."""

import math
from dataclasses import dataclass, replace

import mujoco
import numpy as np

from nomad_mj.arenas.footprints import reach
from nomad_mj.arenas.names import MOVING, goal_site, is_moving, room_name
from nomad_mj.errors import ModelError
from nomad_mj.movers.drift import Drift, MovingGoal, MovingObstacles
from nomad_mj.movers.stroll import Walker, Walkers
from nomad_mj.robots import collides


@dataclass(frozen=True)
class MovingBody:
    """A body that is moved from control step to control step.

    Attributes
    ----------
    name : str
        As in the room's file.
    row : int
        Of it in ``data.mocap_pos``.
    drift : Drift
        How it moves; its speed is a number.
    offset : (float, float)
        From the body to what counts, the goal's site [m, world frame].
    radius : float
        Of the upright cylinder around all that collides [m]; 0 for a goal.
    home : (float, float) or None
        Where it starts if nothing is in the way [m]; None for anywhere.
    walker : Walker or None
        How it walks, if it does so and does not drift.
    """

    name: str
    row: int
    drift: Drift
    offset: tuple[float, float] = (0.0, 0.0)
    radius: float = 0.0
    home: tuple[float, float] | None = None
    walker: Walker | None = None


@dataclass(frozen=True)
class Moving:
    """All that moves in a scene beside the robot.

    Attributes
    ----------
    goal : MovingBody or None
        The body under the goal's site; None for a goal that rests.
    obstacles : tuple of MovingBody
        In the order of the file, then those of the options.
    """

    goal: MovingBody | None
    obstacles: tuple[MovingBody, ...]

    def __bool__(self) -> bool:
        return self.goal is not None or bool(self.obstacles)


def read_moving(
    model: mujoco.MjModel,
    room: str,
    speed: float,
    goal: MovingGoal | None = None,
    obstacles: MovingObstacles | None = None,
    added: tuple[str, ...] = (),
) -> Moving:
    """Return what moves in a compiled room.

    Parameters
    ----------
    model : mujoco.MjModel
        The room, with or without a robot in it.
    room : str
        Its name, for errors.
    speed : float
        Largest speed of what does not say its own [m/s].
    goal, obstacles : optional
        How the goal and the obstacles called `added` move. All else moves along its body's x axis.
    added : tuple of str
        Names of the bodies that the options added.

    Raises
    ------
    ModelError
        A body that should move and is no mocap body, or a goal that collides.
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    _check_names(model, room)
    moving_goal = _goal(model, data, room, speed, goal)
    found: list[MovingBody] = []
    for body in np.flatnonzero(model.body_mocapid >= 0).tolist():
        if is_moving(model, body) and (geoms := _colliding(model, body)):
            mine = obstacles if room_name(model.body(body).name) in added else None
            made = _obstacle(model, data, body, geoms, speed, mine)
            walker = _walker(model, data, body, room, made.drift, mine)
            found.append(replace(made, walker=walker))
    return Moving(moving_goal, tuple(found))


def _goal(
    model: mujoco.MjModel, data: mujoco.MjData, room: str, speed: float, config: MovingGoal | None
) -> MovingBody | None:
    """Return the body under the goal's site if it moves, by the options or along its x axis."""
    site = goal_site(model)
    under = int(model.body_rootid[model.site_bodyid[site]])
    if model.body_mocapid[under] < 0:
        return None
    _check_goal(model, room, under)
    x, y, _ = (data.site_xpos[site] - data.xpos[under]).tolist()
    return MovingBody(
        room_name(model.body(under).name),
        int(model.body_mocapid[under]),
        _drift(config or _along(data, under), speed),
        offset=(x, y),
    )


def _obstacle(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    body: int,
    geoms: list[int],
    speed: float,
    config: MovingObstacles | None,
) -> MovingBody:
    """Return a moving obstacle of the options, which has a config, or of the room's file."""
    x, y, _ = data.xpos[body].tolist()
    return MovingBody(
        room_name(model.body(body).name),
        int(model.body_mocapid[body]),
        _drift(config or _along(data, body), speed),
        radius=max(reach(model, data, geom, data.xpos[body]) for geom in geoms),
        home=(x, y) if config is None else None,
    )


def _walker(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    body: int,
    room: str,
    drift: Drift,
    config: MovingObstacles | None,
) -> Walker | None:
    """Return how a body walks, by the options or by its `user` data in the file; None: it drifts.

    The sites whose names begin with the body's, ``_way`` behind it, are its way points.
    """
    if config is not None:
        assert drift.speed is not None
        return Walker(drift.speed, config.pause) if isinstance(config, Walkers) else None
    speed, pause = np.pad(model.body_user[body], (0, 2))[:2].tolist()
    if speed == 0 and pause == 0:
        return None
    name = room_name(model.body(body).name)
    if not (0 < speed < math.inf and 0 <= pause < math.inf):
        raise ModelError(
            f"room {room!r}: body {name!r} has user data {speed:g} {pause:g}: a walker's must be "
            'its speed in m/s, above 0, and its longest pause in s, such as user="0.6 2"'
        )
    sites = (
        s for s in range(model.nsite) if room_name(model.site(s).name).startswith(f"{name}_way")
    )
    way = [data.site_xpos[site] for site in sites]
    places = [(float(x), float(y)) for x, y, _ in ([data.xpos[body], *way] if way else [])]
    return Walker(speed, pause, tuple(places))


def _along(data: mujoco.MjData, body: int) -> Drift:
    """Return a drift along the x axis of a body."""
    return Drift(float(np.arctan2(data.xmat[body][3], data.xmat[body][0])))


def _drift(given: Drift, speed: float) -> Drift:
    """Return what all drifts have in common, its speed a number."""
    plain = Drift(given.direction, given.speed, given.spread, given.period)
    return plain if plain.speed is not None else replace(plain, speed=speed)


def _colliding(model: mujoco.MjModel, body: int) -> list[int]:
    """Return the geoms of a body and of those on it that other things run into."""
    on_it = model.body_rootid[model.geom_bodyid] == body
    return [int(geom) for geom in np.flatnonzero(on_it & collides(model))]


def _check_names(model: mujoco.MjModel, room: str) -> None:
    for body in range(1, model.nbody):
        name = room_name(model.body(body).name)
        if name.startswith(MOVING) and model.body_mocapid[model.body_rootid[body]] < 0:
            raise ModelError(
                f'room {room!r}: body {name!r} cannot move: give it mocap="true", or a name that '
                f"does not begin with {MOVING!r}"
            )


def _check_goal(model: mujoco.MjModel, room: str, under: int) -> None:
    for geom in _colliding(model, under):
        name = room_name(model.geom(geom).name) or f"geom {geom}"
        raise ModelError(
            f"room {room!r}: {name!r} moves with the goal, so nothing may run into it: give it "
            'contype="0" conaffinity="0"'
        )
