"""Choose the goal and the starts of a room that has none, and check those that it has."""

from dataclasses import replace

import mujoco
import numpy as np
import shapely
from shapely.ops import polylabel

from nomad_mj.arenas import Arena, FloorPlan, check_arena
from nomad_mj.arenas.halton import RADIUS, ROBOT_HEIGHT, halton_starts
from nomad_mj.errors import ConfigError, ModelError, StartError
from nomad_mj.rooms.mjcf import to_mjcf
from nomad_mj.rooms.room import MOST_STARTS, Room

DEFAULT_STARTS = 20
_PRECISION = 0.05  # [m], of the most open place


def floor_plan(room: Room) -> FloorPlan:
    """Return the floor plan of a room, as the scene would read it off its MJCF file."""
    try:
        model = mujoco.MjModel.from_xml_string(to_mjcf(room))
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"room {room.name!r} makes no model: {reason}") from None
    return FloorPlan.from_model(model, ROBOT_HEIGHT)


def furnish(
    room: Room,
    goal: tuple[float, float] | None = None,
    starts: int | None = None,
    radius: float = RADIUS,
) -> Room:
    """Return a room whose goal and starts a robot fits at, and that are connected.

    Parameters
    ----------
    room : Room
        Its goal is kept, or put in the most open place if it has none; its starts are kept, or
        taken from the Halton sequence if it has none.
    goal : (float, float), optional
        The goal [m] in place of the room's own.
    starts : int, optional
        How many, in place of the room's own starts. By default up to 20, as many as there are.
    radius : float
        Of the robot [m].

    Raises
    ------
    StartError
        The robot does not fit at a place, cannot go from there to the goal, or there are not so
        many starts.
    """
    if starts is not None and not 1 <= starts <= MOST_STARTS:
        raise ConfigError(f"starts {starts}: must be 1 to {MOST_STARTS}")
    if goal is not None and not np.isfinite(goal).all():
        raise ConfigError(f"goal {goal}: must be x, y in metres")
    plan = floor_plan(room)
    target = goal or room.goal or _most_open(room, plan, radius)
    _check_inside(room, plan, target, radius)
    chosen = room.starts
    if starts is not None or not chosen:
        count, fewest = (DEFAULT_STARTS, 1) if starts is None else (starts, starts)
        places = halton_starts(plan, count, target, radius, fewest=fewest)
        chosen = tuple((round(float(x), 4), round(float(y), 4), 0.0) for x, y in places)
    names = tuple(f"start_{number}" for number in range(len(chosen)))
    arena = Arena(room.name, np.array(target), np.array(chosen), names, ())
    check_arena(plan, arena, radius)
    return replace(room, goal=target, starts=chosen)


def _check_inside(room: Room, plan: FloorPlan, goal: tuple[float, float], radius: float) -> None:
    """Raise StartError for a goal that is not within the walls."""
    what = f"room {room.name!r}: goal ({goal[0]:g}, {goal[1]:g}) is outside"
    x0, y0, x1, y1 = room.bounds
    if not (x0 <= goal[0] <= x1 and y0 <= goal[1] <= y1):
        raise StartError(f"{what}; the room reaches from ({x0:g}, {y0:g}) to ({x1:g}, {y1:g})")
    if not shapely.box(x0, y0, x1, y1).buffer(_PRECISION).contains(plan.free_space(radius, goal)):
        raise StartError(f"{what} of its walls, or there is a gap in them")


def _most_open(room: Room, plan: FloorPlan, radius: float) -> tuple[float, float]:
    """Return the centre of the largest disc in the largest part of the floor, to a centimetre."""
    blocked = shapely.union_all(plan.footprints).buffer(radius)
    parts = shapely.get_parts(shapely.difference(shapely.box(*room.bounds), blocked))
    parts = [part for part in parts if part.area > 0]
    if not parts:
        raise StartError(f"room {room.name!r}: a robot of radius {radius:g} m fits nowhere in it")
    place = polylabel(max(parts, key=lambda part: part.area), _PRECISION)
    return round(place.x, 2), round(place.y, 2)
