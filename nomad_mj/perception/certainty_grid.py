"""The certainty grid: where obstacles are likely, from one round of range readings.

Source: section 2.1.2 of the paper, after Moravec and Elfes. Cells before a cone's reflection
surface are empty; cells on it are occupied, more surely in the middle of the cone than at its
edge; cells behind it count as occupied too. Nothing is integrated over time.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from nomad_mj.types import FloatArray, IntArray, SensorLayout

_BINS = 1440  # quarters of a degree: a turret's heading is rounded to this
_AT_ONCE = 16  # grids that are filled together: what they take stays in the processor's cache


@dataclass(frozen=True)
class GridSpec:
    """Size of the certainty grid and the sensor model that fills it.

    Attributes
    ----------
    cells : int
        Cells along a side; odd, so that one cell is centred on the robot.
    resolution : float
        Side of a cell [m].
    perception_range : float
        Readings from here on [m] count as a miss.
    edge_certainty : float
        Occupancy probability on the reflection surface at the edge of a cone, in [0, 1]; 1 on
        its axis.
    unseen : float
        Occupancy probability of a cell that no cone covers.
    """

    cells: int = 21
    resolution: float = 0.2
    perception_range: float = 2.0
    edge_certainty: float = 0.5
    unseen: float = 0.5


class _Tables(NamedTuple):
    """What depends on the layout alone; K is the largest number of cones that cover a place."""

    sensor: IntArray  # (K, bins) sensors whose cone covers a direction, count where there is none
    certainty: FloatArray  # (K, bins) certainty at that direction
    reach: FloatArray  # (K, bins) farthest distance from the centre that a sensor tells of
    limit: FloatArray  # (count,) readings from here on are a miss
    angle: FloatArray  # (cells**2,) bearing of each cell's centre, in bins
    distance: FloatArray  # (cells**2,) from the robot's centre to each cell's centre
    outside: FloatArray  # (cells**2,) 0 where the robot itself stands, else 1


def cell_centres(spec: GridSpec) -> FloatArray:
    """Return the cells' centres (cells, cells, 2) [m], from the robot; rows run along y."""
    axis = (np.arange(spec.cells, dtype=np.float64) - spec.cells // 2) * spec.resolution
    return np.stack(np.meshgrid(axis, axis), axis=-1)


@lru_cache(maxsize=16)
def _tables(layout: SensorLayout, spec: GridSpec) -> _Tables:
    bearings = np.concatenate([ring.bearings for ring in layout.rings])
    sizes = [len(ring.bearings) for ring in layout.rings]
    half_angle = np.repeat([ring.half_angle for ring in layout.rings], sizes)
    max_range = np.repeat([ring.max_range for ring in layout.rings], sizes)
    direction = np.arange(_BINS)[:, None] * (2 * np.pi / _BINS)
    off_axis = np.abs((direction - bearings + np.pi) % (2 * np.pi) - np.pi)
    covers = off_axis <= half_angle + np.pi / _BINS
    depth = max(int(covers.sum(axis=1).max()), 1)
    order = np.argsort(~covers, axis=1, kind="stable")[:, :depth]
    covered = np.take_along_axis(covers, order, axis=1)
    relative = np.take_along_axis(off_axis / half_angle, order, axis=1)
    sensor = np.where(covered, order, len(bearings))
    certainty = 1 - (1 - spec.edge_certainty) * np.minimum(relative, 1.0) ** 2
    centres = cell_centres(spec).reshape(-1, 2)
    distance = np.hypot(centres[:, 0], centres[:, 1])
    return _Tables(
        sensor=np.ascontiguousarray(sensor.T),
        certainty=np.ascontiguousarray(certainty.T),
        reach=np.ascontiguousarray(np.append(max_range + layout.radius, -np.inf)[sensor].T),
        limit=np.minimum(max_range, spec.perception_range),
        angle=np.arctan2(centres[:, 1], centres[:, 0]) * (_BINS / (2 * np.pi)),
        distance=distance,
        outside=(distance > layout.radius).astype(np.float64),
    )


def certainty_grid(
    ranges: FloatArray, heading: FloatArray | float, layout: SensorLayout, spec: GridSpec
) -> FloatArray:
    """Return the occupancy probabilities around the robot, oriented as the world.

    Parameters
    ----------
    ranges : array (..., layout.count)
        Readings of all rings, concatenated [m], from the robot's perimeter.
    heading : array (...)
        Direction in the world of the sensors' frame (the turret) [rad].
    layout, spec
        The robot's sensors and the grid.

    Returns
    -------
    array (..., cells, cells)
        Row i, column j is centred at ``cell_centres(spec)[i, j]`` from the robot.
    """
    tables = _tables(layout, spec)
    lead = np.shape(ranges)[:-1]
    readings = np.reshape(ranges, (-1, layout.count))
    headings = np.broadcast_to(np.asarray(heading, dtype=np.float64), lead).reshape(-1)
    surfaces = np.full((len(readings), layout.count + 1), np.inf)  # the last: of no sensor
    np.add(readings, layout.radius, out=surfaces[:, :-1], where=readings < tables.limit)
    grids = np.empty((len(readings), spec.cells**2))
    for first in range(0, len(readings), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        _fill(grids[part], surfaces[part], headings[part], tables, spec)
    return grids.reshape(*lead, spec.cells, spec.cells)


def _fill(
    grids: FloatArray, surfaces: FloatArray, headings: FloatArray, tables: _Tables, spec: GridSpec
) -> None:
    """Fill grids (n, cells**2), given how far each sensor's surface is (n, count + 1) [m]."""
    turn = headings[:, None] * (_BINS / (2 * np.pi))
    bins = np.rint(tables.angle - turn).astype(np.intp)
    np.remainder(bins, _BINS, out=bins)  # (n, cells**2)
    sensor = tables.sensor.take(bins, axis=1)  # (K, n, cells**2)
    sensor += np.arange(0, surfaces.size, surfaces.shape[1])[:, None]
    # A ramp over half a cell, so that the grid changes smoothly with the readings.
    ramp = surfaces.ravel().take(sensor)
    np.subtract(tables.distance, ramp, out=ramp)
    ramp *= 2 / spec.resolution
    ramp += 1
    np.minimum(np.maximum(ramp, 0, out=ramp), 1, out=ramp)
    ramp *= tables.certainty.take(bins, axis=1)
    np.copyto(ramp, np.inf, where=tables.distance > tables.reach.take(bins, axis=1))
    # A cone tells of the nearest thing in it, so wherever one is empty nothing can be.
    np.minimum.reduce(ramp, axis=0, out=grids)
    np.copyto(grids, spec.unseen, where=np.isinf(grids))
    grids *= tables.outside
