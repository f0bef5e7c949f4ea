"""The certainty grid: where obstacles are likely, from one round of range readings.

Source: section 2.1.2 of the paper, after Moravec and Elfes. Cells before a cone's reflection
surface are empty; cells on it are occupied, more surely in the middle of the cone than at its
edge; cells behind it count as occupied too. Nothing is integrated over time.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from nomad_mj.errors import ConfigError
from nomad_mj.limits import MOST, TINY, require
from nomad_mj.perception.side_by_side import AT_ONCE, side_by_side
from nomad_mj.types import FloatArray, IntArray, RangeRing, SensorLayout

MOST_CELLS = 401
_BINS = 1440  # quarters of a degree: a turret's heading is rounded to this


_Value = TypeVar("_Value", bound=np.generic)


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

    def __post_init__(self) -> None:
        require(
            self,
            cells=(1, MOST_CELLS),
            resolution=(TINY, MOST),
            perception_range=(TINY, MOST),
            edge_certainty=(0.0, 1.0),
            unseen=(0.0, 1.0),
        )
        if self.cells % 2 != 1:
            raise ConfigError(f"cells {self.cells}: must be odd, so that one is the robot's")


class _Layer(NamedTuple):
    """Cones of a ring of which none covers another; P places: cells that they reach, of n robots.

    Of places, arrays hold `AT_ONCE` robots; of directions two turns and the beginning of a third,
    D, so that none need be wrapped.
    """

    covered: npt.NDArray[np.bool_] | None  # (D,) whether a cone covers a direction; None: all
    sensor: IntArray  # (D,) which
    certainty: FloatArray  # (D,) at that direction
    place: IntArray | None  # (P,) each place, as an index of grids (n, cells**2); None: all
    robot: IntArray  # (P,) its robot's first reading, as an index of readings (n, count)
    distance: FloatArray  # (P,) from its robot's centre [m]


class _Tables(NamedTuple):
    """What depends on the layout alone."""

    layers: tuple[_Layer, ...]
    whole: bool  # whether one of them tells of every cell
    limit: FloatArray  # (count,) readings from here on are a miss
    angle: FloatArray  # (cells**2,) bearing of each cell's centre, in bins
    inside: IntArray  # cells where the robot itself stands


def cell_centres(spec: GridSpec) -> FloatArray:
    """Return the cells' centres (cells, cells, 2) [m], from the robot; rows run along y."""
    axis = (np.arange(spec.cells, dtype=np.float64) - spec.cells // 2) * spec.resolution
    return np.stack(np.meshgrid(axis, axis), axis=-1)


@lru_cache(maxsize=16)
def _tables(layout: SensorLayout, spec: GridSpec) -> _Tables:
    centres = cell_centres(spec).reshape(-1, 2)
    distance = np.hypot(centres[:, 0], centres[:, 1])
    sizes = [len(ring.bearings) for ring in layout.rings]
    max_range = np.repeat([ring.max_range for ring in layout.rings], sizes)
    firsts = np.cumsum([0, *sizes])
    layers = [
        layer
        for ring, first in zip(layout.rings, firsts.tolist(), strict=False)
        for layer in _layers(ring, first, distance, layout, spec)
    ]
    return _Tables(
        layers=tuple(layers),
        whole=any(layer.covered is None and layer.place is None for layer in layers),
        limit=np.minimum(max_range, spec.perception_range),
        angle=np.arctan2(centres[:, 1], centres[:, 0]) * (_BINS / (2 * np.pi)),
        inside=np.flatnonzero(distance <= layout.radius),
    )


def _layers(
    ring: RangeRing, first: int, distance: FloatArray, layout: SensorLayout, spec: GridSpec
) -> list[_Layer]:
    """Return the layers of a ring whose first sensor is number `first`."""
    direction = np.arange(_BINS)[:, None] * (2 * np.pi / _BINS)
    off_axis = np.abs((direction - ring.bearings + np.pi) % (2 * np.pi) - np.pi)
    covers = off_axis <= ring.half_angle + np.pi / _BINS
    order = np.argsort(~covers, axis=1, kind="stable")
    relative = off_axis / ring.half_angle
    certainty = 1 - (1 - spec.edge_certainty) * np.minimum(relative, 1.0) ** 2
    reached = np.flatnonzero(distance <= ring.max_range + layout.radius)
    robots = np.arange(AT_ONCE)[:, None]
    layers: list[_Layer] = []
    for sensor in order.T:
        covered = np.take_along_axis(covers, sensor[:, None], axis=1)[:, 0]
        if not covered.any():
            break
        certain = np.take_along_axis(certainty, sensor[:, None], axis=1)[:, 0]
        layers.append(
            _Layer(
                covered=None if covered.all() else _two_turns(covered),
                sensor=_two_turns(sensor + first),
                certainty=_two_turns(certain),
                place=None
                if len(reached) == len(distance)
                else (robots * len(distance) + reached).ravel(),
                robot=np.repeat(robots * layout.count, len(reached)),
                distance=np.tile(distance[reached], AT_ONCE),
            )
        )
    return layers


def _two_turns(values: npt.NDArray[_Value]) -> npt.NDArray[_Value]:
    """Return a table of directions (bins,) for the indices of `_bins`."""
    return np.resize(values, 2 * _BINS + 1)


def certainty_grid(
    ranges: FloatArray,
    heading: FloatArray | float,
    layout: SensorLayout,
    spec: GridSpec,
    threads: int = 1,
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
    threads : int
        On so many hundreds of grids are filled side by side, to the same bits.

    Returns
    -------
    array (..., cells, cells)
        Row i, column j is centred at ``cell_centres(spec)[i, j]`` from the robot.
    """
    tables = _tables(layout, spec)
    lead = np.shape(ranges)[:-1]
    readings = np.reshape(ranges, (-1, layout.count))
    headings = np.broadcast_to(np.asarray(heading, dtype=np.float64), lead).reshape(-1)
    surfaces = np.where(readings < tables.limit, readings + layout.radius, np.inf)
    grids = np.empty((len(readings), spec.cells**2))

    def fill(part: slice) -> None:
        _fill(grids[part], surfaces[part], headings[part], tables, spec)

    side_by_side(fill, len(readings), threads)
    return grids.reshape(*lead, spec.cells, spec.cells)


def _fill(
    grids: FloatArray, surfaces: FloatArray, headings: FloatArray, tables: _Tables, spec: GridSpec
) -> None:
    """Fill grids (n, cells**2), given how far each sensor's surface is (n, count) [m]."""
    bins = _bins(tables.angle, headings)
    flat = grids.reshape(-1)
    flat.fill(np.inf)
    for layer in tables.layers:
        place, told = _tell(layer, bins, surfaces, spec)
        # A cone tells of the nearest thing in it, so wherever one is empty nothing can be.
        if place is None:
            np.minimum(told, flat, out=flat)
        else:
            flat[place] = np.minimum(told, flat.take(place), out=told)
    if not tables.whole:
        np.copyto(grids, spec.unseen, where=np.isinf(grids))
    grids[:, tables.inside] = 0.0


def _bins(angle: FloatArray, headings: FloatArray) -> IntArray:
    """Return each cell's direction from each robot's sensors, from 0 to the end of a 2nd turn."""
    turn = headings[:, None] * (_BINS / (2 * np.pi))
    direction = angle - turn
    np.rint(direction, out=direction)
    direction += _BINS * np.ceil(turn / _BINS + 0.5)  # whole numbers: nothing is rounded
    return direction.astype(np.intp).reshape(-1)


def _tell(
    layer: _Layer, bins: IntArray, surfaces: FloatArray, spec: GridSpec
) -> tuple[IntArray | None, FloatArray]:
    """Return places that a layer tells of, as an index of grids, None for all, and what."""
    count = len(layer.robot) // AT_ONCE * len(surfaces)
    robot, distance = layer.robot[:count], layer.distance[:count]
    place = None if layer.place is None else layer.place[:count]
    near = bins if place is None else bins.take(place)
    # All are within the tables: to clip only spares the search for those that are not.
    if layer.covered is not None:
        chosen = np.flatnonzero(layer.covered.take(near, mode="clip"))
        place = chosen if place is None else place.take(chosen)
        robot, distance, near = robot.take(chosen), distance.take(chosen), near.take(chosen)
    reading = layer.sensor.take(near, mode="clip")
    reading += robot
    told = surfaces.take(reading)
    # A ramp over half a cell, so that the grid changes smoothly with the readings.
    np.subtract(distance, told, out=told)
    told *= 2 / spec.resolution
    told += 1
    np.minimum(np.maximum(told, 0, out=told), 1, out=told)
    told *= layer.certainty.take(near, mode="clip")
    return place, told
