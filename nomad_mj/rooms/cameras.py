"""Cameras from which a whole room is seen, whatever its size and shape."""

import math
from collections.abc import Iterable, Iterator

import numpy as np

from nomad_mj.rooms.room import Box, Cylinder, Room, Shape
from nomad_mj.types import FloatArray

ASPECT = 4 / 3
"""Width by height of the pictures that `overview` is for; those of `top` are square or wider."""

_FOVY = 43.0  # [deg]
_FORWARD = np.array([0.632, -0.775])  # of `overview`, in y and z
_UP = np.array([0.775, 0.632])
_MARGIN = 1.07  # times what must be seen


def room_cameras(room: Room) -> tuple[tuple[FloatArray, float], tuple[FloatArray, float]]:
    """Return place (3,) [m] and `fovy` of two cameras from which all of a room is seen.

    The first, `top`, looks straight down and is orthographic, `fovy` in metres; the second,
    `overview`, looks along (0, 0.632, -0.775), `fovy` in degrees.
    """
    x0, y0, x1, y1 = _extent(room)
    x, y = (x0 + x1) / 2, (y0 + y1) / 2
    top = np.array([x, y, room.height + 3.0]), _MARGIN * max(x1 - x0, y1 - y0)
    corners = np.array([[x1 - x, y, z] for y in (y0, y1) for z in (0.0, room.height)])
    up, ahead = corners[:, 1:] @ _UP, corners[:, 1:] @ _FORWARD
    slope = math.tan(math.radians(_FOVY) / 2) / _MARGIN
    # The lines of sight along the picture's lower and upper edge touch the room and meet here ...
    highest, lowest = (up - slope * ahead).max(), (-up - slope * ahead).max()
    at_up, at_ahead = (highest - lowest) / 2, -(highest + lowest) / (2 * slope)
    # ... or so far behind that it is not wider than the picture.
    at_ahead = min(at_ahead, (ahead - corners[:, 0] / (slope * ASPECT)).min())
    return top, (np.array([x, *(at_up * _UP + at_ahead * _FORWARD)]), _FOVY)


def _extent(room: Room) -> tuple[float, float, float, float]:
    """Return the smallest rectangle around the floor and all that stands."""
    x0, y0, x1, y1 = room.bounds
    points = np.array([(x0, y0), (x1, y1), *_corners((*room.walls, *room.obstacles))])
    low, high = points.min(axis=0), points.max(axis=0)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _corners(shapes: Iterable[Shape]) -> Iterator[tuple[float, float]]:
    """Yield places between which shapes lie."""
    for shape in shapes:
        if isinstance(shape, Box):
            cos, sin = abs(math.cos(shape.angle)) / 2, abs(math.sin(shape.angle)) / 2
            half = shape.length * cos + shape.width * sin, shape.length * sin + shape.width * cos
        elif isinstance(shape, Cylinder):
            half = shape.radius, shape.radius
        else:
            yield from shape.corners
            continue
        yield shape.x - half[0], shape.y - half[1]
        yield shape.x + half[0], shape.y + half[1]
