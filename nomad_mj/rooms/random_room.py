"""Rooms made at random, the same for the same seed, which a robot can always solve."""

import math

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


def random_room(seed: int, difficulty: float = 0.5) -> Room:
    """Return a room of 10 x 10 m with boxes and pillars, still without starts.

    All of its free space is connected for a robot of 0.265 m radius with 0.12 m to spare, so that
    every place from which it could start can be solved.

    Parameters
    ----------
    seed : int
        Of the room, 0 or more.
    difficulty : float
        From 0, four small obstacles, to 1, twenty of up to 2.4 m.

    Raises
    ------
    ConfigError
        A seed or difficulty outside these.
    """
    if seed < 0:
        raise ConfigError(f"seed {seed}: must be 0 or more")
    if not 0 <= difficulty <= 1:
        raise ConfigError(f"difficulty {difficulty:g}: must be 0 to 1")
    rng = np.random.default_rng(np.random.SeedSequence(seed))
    outline = ((0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE))
    margin = RADIUS + CLEARANCE
    floor = shapely.box(margin, margin, SIDE - margin, SIDE - margin)
    x, y = (round(float(value), 2) for value in rng.uniform(1.0, SIDE - 1.0, 2))
    goal = shapely.Point(x, y).buffer(_GOAL_SPACE)
    obstacles: list[Shape] = []
    for _ in range(round(4 + 16 * difficulty)):
        for _ in range(_TRIES):
            shape = _draw(rng, difficulty)
            footprint = _footprint(shape)
            left = floor.difference(footprint.buffer(margin))
            if left.geom_type == "Polygon" and not footprint.intersects(goal):
                obstacles.append(shape)
                floor = left
                break
    bounds = (0.0, 0.0, SIDE, SIDE)
    return Room(f"random_{seed}", walls_along(outline), tuple(obstacles), bounds, (x, y))


def _draw(rng: np.random.Generator, difficulty: float) -> Shape:
    """Draw an obstacle; lengths and places are whole centimetres, angles whole degrees."""
    x, y = (round(float(value), 2) for value in rng.uniform(0.0, SIDE, 2))
    half = rng.uniform([0.2, 0.15], [0.5 + 0.7 * difficulty, 0.5])
    length, width = (round(2 * float(value), 2) for value in half)
    degrees, kind = int(rng.integers(0, 180)), int(rng.integers(0, 3))
    if kind == 0:
        return Cylinder(x, y, round(width / 2, 2))
    return Box(x, y, length, width, math.radians(degrees))


def _footprint(shape: Shape) -> BaseGeometry:
    if isinstance(shape, Cylinder):
        return shapely.Point(shape.x, shape.y).buffer(shape.radius)
    assert isinstance(shape, Box)
    box = shapely.box(-shape.length / 2, -shape.width / 2, shape.length / 2, shape.width / 2)
    turned = affinity.rotate(box, shape.angle, origin=(0, 0), use_radians=True)
    return affinity.translate(turned, shape.x, shape.y)
