"""Rooms made at random, the same for the same seed, which a robot can always solve."""

import math
from functools import partial

import numpy as np

from nomad_mj.rooms.room import Box, Cylinder, Room, Shape
from nomad_mj.rooms.scatter import SIDE, check_seed, scattered

_CONVEX, _WIDE, _CONCAVE = range(3)  # kinds of streams; the plain room has the seed's own
_THICK = 0.3  # [m] of the sides of a U


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
    check_seed(seed, difficulty)

    rng = np.random.default_rng(np.random.SeedSequence(seed))
    return scattered(f"random_{seed}", rng, partial(_draw, difficulty), round(4 + 16 * difficulty))


def convex_room(seed: int, difficulty: float = 0.5) -> Room:
    """Return a room like `random_room`'s whose obstacles keep apart, so that each is convex.

    The robot can go all around each of them; there may be fewer than in a `random_room`, which
    lets them overlap.

    Parameters
    ----------
    seed : int
        Of the room, 0 or more.
    difficulty : float
        From 0, four small obstacles, to 1, up to twenty of up to 2.4 m.
    """
    check_seed(seed, difficulty)
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_CONVEX,)))
    count = round(4 + 16 * difficulty)
    return scattered(f"convex_{seed}", rng, partial(_draw, difficulty), count, apart=True)


def wide_room(seed: int, difficulty: float = 0.5) -> Room:
    """Return a room with walls that stand free, wider than a robot that sees 2 m can look past.

    Where the robot stands before the middle of one it sees no end of it, on either side. All else
    is as of `random_room`.

    Parameters
    ----------
    seed : int
        Of the room, 0 or more.
    difficulty : float
        From 0, two walls of 3 to 4 m, to 1, six of 3 to 6 m.
    """
    check_seed(seed, difficulty)

    def draw(rng: np.random.Generator) -> tuple[Shape, ...]:
        x, y = _place(rng)
        length = round(float(rng.uniform(3.0, 4.0 + 2.0 * difficulty)), 2)
        return (Box(x, y, length, _THICK, math.radians(int(rng.integers(0, 180)))),)

    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_WIDE,)))
    return scattered(f"wide_{seed}", rng, draw, round(2 + 4 * difficulty), apart=True)


def concave_room(seed: int, difficulty: float = 0.5) -> Room:
    """Return a room with obstacles in the shape of a U, open to any side.

    A robot in one that goes straight for a goal behind it has to turn back. All else is as of
    `random_room`.

    Parameters
    ----------
    seed : int
        Of the room, 0 or more.
    difficulty : float
        From 0, two with sides of 0.8 to 1 m, to 1, six with sides of 0.8 to 2.2 m.
    """
    check_seed(seed, difficulty)

    def draw(rng: np.random.Generator) -> tuple[Shape, ...]:
        x, y = _place(rng)
        inside = round(float(rng.uniform(1.2, 2.4)), 2)  # wide enough to go in and turn round
        depth = round(float(rng.uniform(0.8, 1.0 + 1.2 * difficulty)), 2)
        return _u_shape(x, y, inside, depth, math.radians(int(rng.integers(0, 360))))

    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_CONCAVE,)))
    return scattered(f"concave_{seed}", rng, draw, round(2 + 4 * difficulty), apart=True)


def _draw(difficulty: float, rng: np.random.Generator) -> tuple[Shape, ...]:
    """Draw an obstacle; lengths and places are whole centimetres, angles whole degrees."""
    x, y = _place(rng)
    half = rng.uniform([0.2, 0.15], [0.5 + 0.7 * difficulty, 0.5])
    length, width = (round(2 * float(value), 2) for value in half)
    degrees, kind = int(rng.integers(0, 180)), int(rng.integers(0, 3))
    if kind == 0:
        return (Cylinder(x, y, round(width / 2, 2)),)
    return (Box(x, y, length, width, math.radians(degrees)),)


def _place(rng: np.random.Generator) -> tuple[float, float]:
    x, y = (round(float(value), 2) for value in rng.uniform(0.0, SIDE, 2))
    return x, y


def _u_shape(x: float, y: float, inside: float, depth: float, angle: float) -> tuple[Box, ...]:
    """Return a back, whose middle is at (x, y), and two sides of `depth` before it [m]."""
    across = (inside + _THICK) / 2
    ahead = (depth + _THICK) / 2
    parts = [(0.0, 0.0, _THICK, inside + 2 * _THICK)]
    parts += [(ahead, side * across, depth, _THICK) for side in (1, -1)]
    cos, sin = math.cos(angle), math.sin(angle)
    return tuple(
        Box(x + cos * u - sin * v, y + sin * u + cos * v, length, width, angle)
        for u, v, length, width in parts
    )
