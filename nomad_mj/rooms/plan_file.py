"""Rooms as a short YAML list of what stands where."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from nomad_mj.errors import ModelError
from nomad_mj.rooms.room import (
    HEIGHT,
    LONGEST_SIDE,
    MOST_SHAPES,
    MOST_STARTS,
    Box,
    Cylinder,
    Polygon,
    Room,
    Shape,
)
from nomad_mj.values import number, numbers, read_yaml, refuse_others

WALL = 0.15
"""How thick walls are [m]."""

_KEYS = ("size", "outline", "height", "obstacles", "goal", "starts")
_SHAPES = ("box", "cylinder", "polygon")


def read_plan(path: Path) -> Room:
    """Return the room that a plan describes: a YAML file with these keys, all in metres.

    ``size: [length, width]`` makes walls around [0, length] x [0, width]; or ``outline: [[x, y],
    ...]`` makes them along a polygon. ``obstacles`` is a list of ``box: [x, y, length, width]``,
    with ``angle`` in degrees, of ``cylinder: [x, y, radius]`` and of ``polygon: [[x, y], ...]``,
    convex. ``goal: [x, y]``, ``starts: [[x, y], [x, y, degrees], ...]`` and ``height`` may be
    left out.

    Raises
    ------
    ModelError
        A file that is missing or no plan, a value that makes no sense.
    """
    what = f"room plan {str(path)!r}"
    held = read_yaml(path, "room")
    refuse_others(held, _KEYS, what)
    if ("size" in held) == ("outline" in held):
        raise ModelError(
            f"{what}: must have either size: [length, width] or outline: [[x, y], ...]"
        )
    if "size" in held:
        x, y = numbers(held["size"], f"{what}: size", 2, low=0.5)
        outline = ((0.0, 0.0), (x, 0.0), (x, y), (0.0, y))
    else:
        outline = _corners(held["outline"], f"{what}: outline")
    x0, y0, x1, y1 = shapely.Polygon(outline).bounds
    if max(x1 - x0, y1 - y0) > LONGEST_SIDE:
        raise ModelError(f"{what}: larger than {LONGEST_SIDE:g} m; lengths are metres")
    obstacles = _list(held, "obstacles", what, MOST_SHAPES)
    shapes = tuple(_shape(each, f"{what}: obstacle {i}") for i, each in enumerate(obstacles, 1))
    goal = numbers(held["goal"], f"{what}: goal", 2) if "goal" in held else None
    starts = [
        numbers(each, f"{what}: start", 2, 3) for each in _list(held, "starts", what, MOST_STARTS)
    ]
    return Room(
        path.stem,
        walls_along(outline),
        shapes,
        (x0, y0, x1, y1),
        None if goal is None else (goal[0], goal[1]),
        tuple((s[0], s[1], math.radians(s[2]) if len(s) == 3 else 0.0) for s in starts),
        number(held.get("height", HEIGHT), f"{what}: height", HEIGHT, 10),
    )


def walls_along(outline: tuple[tuple[float, float], ...]) -> tuple[Box, ...]:
    """Return walls outside of a simple polygon's edges, closed at its corners."""
    points = np.array(outline if shapely.LinearRing(outline).is_ccw else outline[::-1])
    walls: list[Box] = []
    for before, start, end, after in zip(
        np.roll(points, 1, axis=0),
        points,
        np.roll(points, -1, axis=0),
        np.roll(points, -2, axis=0),
        strict=True,
    ):
        along = (end - start) / np.linalg.norm(end - start)
        # Past a corner that bends outwards a longer wall would stand in the room.
        first = start - WALL * along * _left(start - before, end - start)
        last = end + WALL * along * _left(end - start, after - end)
        x, y = (first + last) / 2 + WALL / 2 * np.array([along[1], -along[0]])
        angle = math.atan2(along[1], along[0])
        walls.append(Box(float(x), float(y), float(np.hypot(*(last - first))), WALL, angle))
    return tuple(walls)


def _left(a: Any, b: Any) -> bool:
    return bool(a[0] * b[1] - a[1] * b[0] > 0)


def _list(held: dict[Any, Any], key: str, what: str, most: int) -> list[Any]:
    value = held.get(key, [])
    if not isinstance(value, list):
        raise ModelError(f"{what}: {key} must be a list, one a line after '-'")
    if len(value) > most:
        raise ModelError(f"{what}: {len(value)} {key}; at most {most}")
    return value


def _shape(entry: Any, what: str) -> Shape:
    kinds = [kind for kind in _SHAPES if isinstance(entry, dict) and kind in entry]
    if len(kinds) != 1:
        raise ModelError(f"{what}: must be one of: {', '.join(_SHAPES)}")
    kind = kinds[0]
    refuse_others(entry, ("box", "angle") if kind == "box" else (kind,), what)
    if kind == "polygon":
        corners = _corners(entry[kind], what)
        outline = shapely.Polygon(corners)
        if outline.convex_hull.area > outline.area * (1 + 1e-6):
            raise ModelError(f"{what}: a polygon must be convex; make it of two")
        return Polygon(corners)
    values = numbers(entry[kind], f"{what}: {kind}", 4 if kind == "box" else 3)
    sizes = tuple(number(size, f"{what}: size", 0.001, 1000) for size in values[2:])
    if kind == "cylinder":
        return Cylinder(values[0], values[1], sizes[0])
    angle = number(entry.get("angle", 0), f"{what}: angle", -360, 360)
    return Box(values[0], values[1], sizes[0], sizes[1], math.radians(angle))


def _corners(value: Any, what: str) -> tuple[tuple[float, float], ...]:
    if not isinstance(value, list) or not 3 <= len(value) <= 1000:
        raise ModelError(f"{what}: must be a list of three or more corners [x, y]")
    found = [numbers(each, f"{what}: corner", 2) for each in value]
    corners = tuple((x, y) for x, y in found)
    outline = shapely.Polygon(corners)
    if not outline.is_valid or outline.area < 1e-4 or len(set(corners)) < len(corners):
        raise ModelError(f"{what}: its edges cross or touch, or it has no area")
    return corners
