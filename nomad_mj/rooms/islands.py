"""Things that stand free on a map, each as one pillar, box or prism if that is what it is."""

import math

import numpy as np
import shapely
from scipy import ndimage
from shapely.geometry.base import BaseGeometry

from nomad_mj.errors import ModelError
from nomad_mj.rooms.rectangles import Mask
from nomad_mj.rooms.room import MOST_SHAPES, Box, Cylinder, Polygon, Shape
from nomad_mj.types import FloatArray

MOST_CORNERS = 16
_SMALLEST_ROUND = 2.0  # cells; what is smaller is a box


def fit_islands(inside: Mask) -> tuple[list[Shape], Mask]:
    """Find the things in a free space that a round or a convex shape shows, to a cell.

    Parameters
    ----------
    inside : ndarray of bool, shape (R, C)
        The free space; its border is not free.

    Returns
    -------
    shapes : list of Box, Cylinder or Polygon
        In cells: x counts columns, y rows.
    shown : ndarray of bool, shape (R, C)
        The cells that these stand for.

    Raises
    ------
    ModelError
        There are too many things.
    """
    labels = np.empty(inside.shape, dtype=np.int32)
    ndimage.label(~inside, np.ones((3, 3)), output=labels)
    count = int(labels.max()) - 1  # the first is what lies outside
    if count > MOST_SHAPES:
        raise too_many(count)
    shapes: list[Shape] = []
    found = [int(labels[0, 0])]
    for index, where in enumerate(ndimage.find_objects(labels), 1):
        if index == found[0]:  # what is around the free space
            continue
        shape = _fit(labels[where] == index, (where[1].start, where[0].start))
        if shape is not None:
            shapes.append(shape)
            found.append(index)
    return shapes, np.isin(labels, found[1:])


def too_many(count: int) -> ModelError:
    """Return the error that tells of a map that is mostly noise."""
    return ModelError(
        f"shows {count} separate walls and things; at most {MOST_SHAPES}: clean it, make it "
        "coarser, or take a part of it by 'within' (--within METRES)"
    )


def _fit(part: Mask, corner: tuple[int, int]) -> Shape | None:
    """Return a round or convex shape like cells whose first is at a column and row, or None."""
    cells = np.pad(part, 2)
    row, column = np.nonzero(cells)
    shift = np.array(corner) - 2
    middle = np.array([column.mean(), row.mean()]) + 0.5
    radius = math.sqrt(len(row) / math.pi)
    disc = shapely.Point(middle).buffer(radius, quad_segs=16)
    corners = np.concatenate([np.stack([column + i, row + j], -1) for i in (0, 1) for j in (0, 1)])
    hull = shapely.MultiPoint(corners).convex_hull
    rectangle = shapely.minimum_rotated_rectangle(hull)
    off_disc = _misfit(cells, disc) if radius > _SMALLEST_ROUND else math.inf
    off_rectangle = _misfit(cells, rectangle)
    if off_disc < off_rectangle:
        x, y = (middle + shift).tolist()
        return Cylinder(x, y, radius)
    if off_rectangle < math.inf:
        return _box(shapely.get_coordinates(rectangle) + shift)
    outline = shapely.simplify(hull, 0.5)
    points = shapely.get_coordinates(outline)[:-1] + shift
    if len(points) <= MOST_CORNERS and _misfit(cells, outline) < math.inf:
        return Polygon(tuple((float(x), float(y)) for x, y in points))
    return None


def _box(corners: FloatArray) -> Box:
    """Return the box whose corners (4 or more, 2) these are, in order."""
    along, across = corners[1] - corners[0], corners[2] - corners[1]
    x, y = corners[:4].mean(axis=0).tolist()
    angle = math.atan2(along[1], along[0])
    return Box(x, y, float(np.hypot(*along)), float(np.hypot(*across)), angle)


def _misfit(cells: Mask, outline: BaseGeometry) -> float:
    """Count the cells in which a convex outline differs; infinite if one is off by more than 1."""
    row, column = np.indices(cells.shape)
    covered = shapely.contains_xy(outline, column + 0.5, row + 0.5)
    added, lost = covered & ~cells, cells & ~covered
    depth = np.asarray(ndimage.distance_transform_edt(~cells))[added]
    missed = shapely.points(np.stack([column, row], axis=-1)[lost] + 0.5)
    gaps = np.asarray(shapely.distance(outline, missed))
    off = max(depth.max(initial=0.0), gaps.max(initial=0.0))
    return float(added.sum() + lost.sum()) if off <= 1 else math.inf
