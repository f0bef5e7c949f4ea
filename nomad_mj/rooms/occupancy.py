"""Occupancy grids, and the room that one of them shows."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from nomad_mj.errors import ModelError
from nomad_mj.geometry import rotate
from nomad_mj.rooms.islands import fit_islands, too_many
from nomad_mj.rooms.rectangles import Mask, merge_cells
from nomad_mj.rooms.room import LONGEST_SIDE, MOST_SHAPES, Box, Cylinder, Polygon, Room, Shape
from nomad_mj.rooms.smooth import straighten, without_specks
from nomad_mj.types import FloatArray

FREE, OCCUPIED, UNKNOWN = 0, 1, 2

_FINE = 0.1
"""In maps with cells as small as this [m], gaps one cell wide are noise: they are filled."""


@dataclass(frozen=True, eq=False)
class Occupancy:
    """What is free, occupied or unknown on a grid of square cells.

    Attributes
    ----------
    cells : ndarray of uint8, shape (R, C)
        `FREE`, `OCCUPIED` or `UNKNOWN`. Row 0 lies at the lowest y, column 0 at the lowest x of
        the grid's own frame: an image is upside down.
    resolution : float
        Side of a cell [m].
    origin : (float, float, float)
        Outer corner of cell (0, 0), x and y [m], and the angle of the grid's x axis [rad], in the
        world frame.
    """

    cells: npt.NDArray[np.uint8]
    resolution: float
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if not (math.isfinite(self.resolution) and self.resolution > 0):
            raise ModelError(f"resolution {self.resolution:g}: must be metres a cell, above 0")
        if not all(math.isfinite(value) and abs(value) <= 1e6 for value in self.origin):
            raise ModelError(f"origin {self.origin}: must be x, y in metres and yaw in radians")
        rows, columns = self.cells.shape
        side = self.resolution * max(rows, columns)
        if side > LONGEST_SIDE:
            raise ModelError(
                f"{columns} x {rows} cells of {self.resolution:g} m make {side:g} m; "
                f"at most {LONGEST_SIDE:g} m, so give a smaller resolution in metres a cell"
            )

    def to_world(self, points: npt.ArrayLike) -> FloatArray:
        """Return places (..., 2), given as fractions of column and row, in the world [m]."""
        x, y, yaw = self.origin
        return rotate(np.asarray(points) * self.resolution, yaw) + np.array([x, y])

    def cell_at(self, place: npt.ArrayLike) -> tuple[int, int]:
        """Return row and column of the cell at a place (2,) of the world [m]; may lie outside."""
        x, y, yaw = self.origin
        column, row = rotate(np.asarray(place) - np.array([x, y]), -yaw) / self.resolution
        return math.floor(row), math.floor(column)


def room_of_map(
    grid: Occupancy, name: str, goal: tuple[float, float] | None = None, within: float = math.inf
) -> Room:
    """Return the room that a map shows, still without starts.

    Of all free space only one connected part becomes the room: that of the goal or, without one,
    the largest. Whatever borders on it, diagonally too, is wall, be it occupied, unknown or the
    end of the map. What lies farther off can neither be seen nor be touched and is left out,
    or filled where that makes for fewer boxes. In maps with cells of up to 0.1 m noise goes: gaps
    one cell wide are filled, unknown spots in free space are free, bumps and notches one cell deep
    are made straight, and what stands free becomes a pillar, box or prism if that is what it is.

    Parameters
    ----------
    grid : Occupancy
        The map.
    name : str
        What to call the room.
    goal : (float, float), optional
        In the world frame [m]; the free place farthest from everything unless it is given.
    within : float
        Of the map, only what is no farther than this from the goal in x and in y [m].

    Raises
    ------
    ModelError
        No free space, none at the goal, or too many walls and things.
    """
    free = _free(grid)
    inside = _region(grid, free, goal)
    if goal is None:
        depth = np.asarray(ndimage.distance_transform_edt(inside))
        row, column = np.unravel_index(int(np.argmax(depth)), inside.shape)
        x, y = grid.to_world((column - 0.5, row - 0.5))
        goal = round(float(x), 4), round(float(y), 4)
    if math.isfinite(within):
        near = _near(grid, inside.shape, goal, within)
        inside = _region(grid, np.logical_and(inside, near), goal)
    walls, things = _shapes(grid, inside)
    if len(walls) + len(things) > MOST_SHAPES:
        raise too_many(len(walls) + len(things))
    rows, columns = np.nonzero(inside)
    low, high = (columns.min() - 1, rows.min() - 1), (columns.max(), rows.max())
    outline = grid.to_world([low, (high[0], low[1]), high, (low[0], high[1])])
    x0, y0, x1, y1 = *outline.min(axis=0).tolist(), *outline.max(axis=0).tolist()
    return Room(name, walls, things, (x0, y0, x1, y1), goal)


def _shapes(grid: Occupancy, inside: Mask) -> tuple[tuple[Box, ...], tuple[Shape, ...]]:
    """Return the walls around the free space of a padded map, and what stands free in it."""
    things: list[Shape] = []
    shown: Mask = np.zeros_like(inside)
    if grid.resolution <= _FINE:
        things, shown = fit_islands(inside)
        inside = ~(straighten(~(inside | shown)) | shown)
    grown = ndimage.binary_dilation(inside, np.ones((3, 3)))
    shell = np.logical_and(grown, ~(inside | shown))
    rectangles = merge_cells(shell, ~(inside | shell | shown)) - 1
    walls = tuple(_box(grid, rectangle) for rectangle in rectangles)
    return walls, tuple(_obstacle(grid, thing) for thing in things)


def _free(grid: Occupancy) -> Mask:
    """Return the free cells, one more all around; of a fine map without its noise."""
    free = grid.cells == FREE
    if grid.resolution > _FINE:
        return np.pad(free, 1)
    free = np.pad(without_specks(free, grid.cells == OCCUPIED), 1)
    return np.asarray(ndimage.binary_opening(free, np.ones((2, 2))), dtype=np.bool_)


def _region(grid: Occupancy, free: Mask, goal: tuple[float, float] | None) -> Mask:
    """Return the cells of the connected free space that is meant."""
    labels = np.empty(free.shape, dtype=np.int32)
    ndimage.label(free, output=labels)
    if not free.any():
        raise ModelError("has no free space; is it negated, or are its thresholds wrong?")
    if goal is None:
        return np.asarray(labels == np.bincount(labels[free]).argmax())
    if not (math.isfinite(goal[0]) and math.isfinite(goal[1])):
        raise ModelError(f"goal {goal}: must be x, y in metres")
    row, column = (index + 1 for index in grid.cell_at(goal))
    within = 0 <= row < free.shape[0] and 0 <= column < free.shape[1]
    if not within or not free[row, column]:
        raise ModelError(
            f"goal ({goal[0]:g}, {goal[1]:g}) is not in free space; the map reaches from "
            "({:g}, {:g}) to ({:g}, {:g})".format(
                *grid.to_world((0, 0)), *grid.to_world(grid.cells.shape[::-1])
            )
        )
    return np.asarray(labels == labels[row, column])


def _near(
    grid: Occupancy, shape: tuple[int, ...], goal: tuple[float, float], within: float
) -> Mask:
    """Return which cells lie within a square around the goal's."""
    row, column = (index + 1 for index in grid.cell_at(goal))
    reach = max(1, int(min(within / grid.resolution, max(shape))))
    near: Mask = np.zeros(shape, dtype=np.bool_)
    near[max(0, row - reach) : row + reach + 1, max(0, column - reach) : column + reach + 1] = True
    return near


def _obstacle(grid: Occupancy, shape: Shape) -> Shape:
    """Return a shape in the world that is given in cells of the padded map."""
    if isinstance(shape, Polygon):
        points = grid.to_world(np.array(shape.corners) - 1)
        return Polygon(tuple((float(x), float(y)) for x, y in points))
    x, y = grid.to_world((shape.x - 1, shape.y - 1)).tolist()
    size = grid.resolution
    if isinstance(shape, Cylinder):
        return Cylinder(x, y, shape.radius * size)
    return Box(x, y, shape.length * size, shape.width * size, shape.angle + grid.origin[2])


def _box(grid: Occupancy, rectangle: npt.NDArray[np.intp]) -> Box:
    row0, column0, row1, column1 = (int(index) for index in rectangle)
    x, y = grid.to_world(((column0 + column1) / 2, (row0 + row1) / 2))
    length, width = (column1 - column0) * grid.resolution, (row1 - row0) * grid.resolution
    return Box(float(x), float(y), length, width, grid.origin[2])
