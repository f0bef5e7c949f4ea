"""A room as plain data: what stands in it, where the goal is and where the robot may start."""

from dataclasses import dataclass
from typing import TypeAlias

HEIGHT = 0.9
"""How high walls and obstacles are unless a room says otherwise [m]; sonars look out at 0.7 m."""

LONGEST_SIDE = 1000.0
"""A room that is larger [m] is taken for a mistake in its unit."""

MOST_STARTS = 1000
MOST_SHAPES = 2000
"""More walls and obstacles are taken for noise: each ray would have to look at all of them."""


@dataclass(frozen=True)
class Box:
    """A box on the floor: centre `x`, `y`, `length` along its own x, `width` [m], `angle` [rad]."""

    x: float
    y: float
    length: float
    width: float
    angle: float = 0.0


@dataclass(frozen=True)
class Cylinder:
    """A pillar on the floor: centre `x`, `y` and `radius` [m]."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True)
class Polygon:
    """A prism on the floor: its convex outline, three or more corners (x, y) [m], either way."""

    corners: tuple[tuple[float, float], ...]


Shape: TypeAlias = Box | Cylinder | Polygon


@dataclass(frozen=True)
class Room:
    """Walls, obstacles, goal and starts, all in one frame: metres, x east, y north.

    Attributes
    ----------
    name : str
        What to call it.
    walls, obstacles : tuple of Box, Cylinder or Polygon
        What the robot must not touch; the difference is in the names and the colours.
    bounds : (float, float, float, float)
        ``x0, y0, x1, y1`` of the floor [m]: what pictures show.
    goal : (float, float), optional
        Where the robot's centre is to go [m]; None while it is not chosen.
    starts : tuple of (float, float, float)
        x, y [m] and heading [rad], 0 along +x, counter-clockwise; empty while not chosen.
    height : float
        Of walls and obstacles [m].
    """

    name: str
    walls: tuple[Shape, ...]
    obstacles: tuple[Shape, ...]
    bounds: tuple[float, float, float, float]
    goal: tuple[float, float] | None = None
    starts: tuple[tuple[float, float, float], ...] = ()
    height: float = HEIGHT
