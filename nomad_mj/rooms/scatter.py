"""Put obstacles into a room at random, so that all of its free space stays connected."""

from collections.abc import Callable

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry.base import BaseGeometry

from nomad_mj.arenas.halton import CLEARANCE, RADIUS
from nomad_mj.errors import ConfigError
from nomad_mj.rooms.plan_file import walls_along
from nomad_mj.rooms.room import Box, Cylinder, Room, Shape

SIDE = 10.0
"""Length and width of the room [m]."""

_TRIES = 60  # an obstacle, before it is left out
_GOAL_SPACE = 0.6  # [m] around the goal's centre

Draw = Callable[[np.random.Generator], tuple[Shape, ...]]
"""Draws one obstacle, of one shape or of several that touch."""


def check_seed(seed: int, difficulty: float) -> None:
    """Raise ConfigError for a seed below 0 or a difficulty outside [0, 1]."""
    if seed < 0:
        raise ConfigError(f"seed {seed}: must be 0 or more")
    if not 0 <= difficulty <= 1:
        raise ConfigError(f"difficulty {difficulty:g}: must be 0 to 1")


def scattered(
    name: str, rng: np.random.Generator, draw: Draw, count: int, *, apart: bool = False
) -> Room:
    """Return a room of 10 x 10 m with obstacles in it, still without starts.

    Parameters
    ----------
    name : str
        What to call it.
    rng : numpy.random.Generator
        Where chance comes from: first the goal, then each obstacle.
    draw : callable
        Draws an obstacle; what would cut the floor in two, for a robot of 0.265 m radius with
        0.12 m to spare, or would stand on the goal, is drawn again.
    count : int
        Of obstacles; fewer if they find no place.
    apart : bool
        Whether the robot can go all around each of them.
    """
    outline = ((0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE))
    margin = RADIUS + CLEARANCE
    floor = shapely.box(margin, margin, SIDE - margin, SIDE - margin)
    x, y = (round(float(value), 2) for value in rng.uniform(1.0, SIDE - 1.0, 2))
    goal = shapely.Point(x, y).buffer(_GOAL_SPACE)
    obstacles: list[Shape] = []
    for _ in range(count):
        for _ in range(_TRIES):
            shapes = draw(rng)
            footprint = shapely.union_all([_footprint(shape) for shape in shapes])
            taken = footprint.buffer(margin)
            left = floor.difference(taken)
            fits = not footprint.intersects(goal) and (not apart or taken.within(floor))
            if fits and left.geom_type == "Polygon":
                obstacles.extend(shapes)
                floor = left
                break
    bounds = (0.0, 0.0, SIDE, SIDE)
    return Room(name, walls_along(outline), tuple(obstacles), bounds, (x, y))


def _footprint(shape: Shape) -> BaseGeometry:
    if isinstance(shape, Cylinder):
        return shapely.Point(shape.x, shape.y).buffer(shape.radius)
    assert isinstance(shape, Box)
    box = shapely.box(-shape.length / 2, -shape.width / 2, shape.length / 2, shape.width / 2)
    turned = affinity.rotate(box, shape.angle, origin=(0, 0), use_radians=True)
    return affinity.translate(turned, shape.x, shape.y)
