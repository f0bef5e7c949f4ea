"""The moving bodies of a compiled scene: which they are, how large, and how they move."""

from dataclasses import dataclass, replace

import mujoco
import numpy as np

from nomad_mj.arenas.footprints import reach
from nomad_mj.arenas.names import MOVING, goal_site, is_moving, room_name
from nomad_mj.errors import ModelError
from nomad_mj.movers.drift import Drift, MovingGoal, MovingObstacles


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
    """

    name: str
    row: int
    drift: Drift
    offset: tuple[float, float] = (0.0, 0.0)
    radius: float = 0.0
    home: tuple[float, float] | None = None


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
    site = goal_site(model)
    under = int(model.body_rootid[model.site_bodyid[site]])
    _check_names(model, room)
    moving_goal = None
    if model.body_mocapid[under] >= 0:
        _check_goal(model, room, under)
        shift: list[float] = (data.site_xpos[site] - data.xpos[under]).tolist()
        moving_goal = MovingBody(
            room_name(model.body(under).name),
            int(model.body_mocapid[under]),
            _drift(goal or _along(data, under), speed),
            offset=(shift[0], shift[1]),
        )
    found: list[MovingBody] = []
    for body in np.flatnonzero(model.body_mocapid >= 0).tolist():
        if is_moving(model, body) and (geoms := _colliding(model, body)):
            mine = obstacles if room_name(model.body(body).name) in added else None
            found.append(_obstacle(model, data, body, geoms, speed, mine))
    return Moving(moving_goal, tuple(found))


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
    collides = (model.geom_contype | model.geom_conaffinity) != 0
    return [int(geom) for geom in np.flatnonzero(on_it & collides)]


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
