"""The floor plan of a room: where a disc fits, and how far it is from the nearest thing."""

from collections.abc import Iterable

import mujoco
import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry.base import BaseGeometry
from typing_extensions import Self

from nomad_mj.arenas.footprints import footprints
from nomad_mj.arenas.names import ROBOT_PREFIX
from nomad_mj.errors import StartError
from nomad_mj.types import FloatArray

OPEN_ROOM_MARGIN = 10.0
"""How far around everything a room without closed walls is taken to reach [m]."""

_QUAD_SEGS = 8
_THINNEST = 1e-6
_BATCH = 256
_MOST_BATCHES = 400


class FloorPlan:
    """Footprints of all that stands in a room, seen by a disc-shaped robot.

    All positions are in the world frame [m].

    Parameters
    ----------
    parts : iterable of (str, geometry)
        Name and footprint of each wall and obstacle.

    Attributes
    ----------
    names : tuple of str
        Names of the footprints' geoms, as the room's file gives them.
    footprints : tuple of geometry
        Convex polygons, in the order of `names`. Those of round things are drawn around them,
        less than 2 mm too wide.
    """

    def __init__(self, parts: Iterable[tuple[str, BaseGeometry]]) -> None:
        named = tuple(parts)
        self.names = tuple(name for name, _ in named)
        self.footprints = tuple(footprint for _, footprint in named)
        self._tree = shapely.STRtree(self.footprints)
        self._union = shapely.union_all(self.footprints)

    @classmethod
    def from_model(
        cls, model: mujoco.MjModel, robot_height: float, exclude_body_prefix: str = ROBOT_PREFIX
    ) -> Self:
        """Read the plan off a compiled room, all bodies at their initial pose, without what moves.

        Parameters
        ----------
        model : mujoco.MjModel
            The room, with or without a robot in it.
        robot_height : float
            What begins above it [m] is no obstacle.
        exclude_body_prefix : str
            Bodies whose name begins so belong to the robot and are left out.

        Raises
        ------
        ModelError
            For a geom that has no footprint: a height field, a plane that is not level.
        """
        return cls(footprints(model, robot_height, exclude_body_prefix))

    @property
    def bounds(self) -> FloatArray:
        """Smallest rectangle around all footprints: ``[x0, y0, x1, y1]``; NaN in an empty plan."""
        return np.asarray(self._union.bounds, dtype=np.float64)

    @property
    def enclosed(self) -> shapely.Polygon | None:
        """The largest floor that closed walls surround, None where there are no such walls."""
        rings = (ring for part in shapely.get_parts(self._union) for ring in part.interiors)
        return max((shapely.Polygon(ring) for ring in rings), key=shapely.area, default=None)

    def describe_bounds(self) -> str:
        """Say where the floor is: what closed walls surround, else the rectangle `bounds`."""
        if not self.footprints:
            return "without bounds"
        x0, y0, x1, y1 = (self.enclosed or self._union).bounds
        return f"{x0:g} to {x1:g} m in x and {y0:g} to {y1:g} m in y"

    def clearance(self, xy: npt.ArrayLike, radius: float) -> FloatArray:
        """Return the distance from a disc's perimeter to the nearest footprint.

        Parameters
        ----------
        xy : array_like, shape (..., 2)
            Centres of the disc.
        radius : float
            Its radius [m].

        Returns
        -------
        ndarray, shape (...)
            In metres; negative where the disc overlaps something, by the depth of the overlap;
            infinite where nothing stands in the room.
        """
        centres = np.asarray(xy, dtype=np.float64)
        if not self.footprints:
            return np.full(centres.shape[:-1], np.inf)
        points = np.asarray(shapely.points(centres.reshape(-1, 2)))
        _, distance = self._tree.query_nearest(points, return_distance=True, all_matches=False)
        inside = distance == 0
        if inside.any():
            distance[inside] = -shapely.distance(points[inside], self._union.boundary)
        return np.asarray(distance - radius).reshape(centres.shape[:-1])

    def nearest_name(self, xy: npt.ArrayLike) -> str:
        """Name the wall or obstacle nearest to one place, given as ``(2,)``."""
        return self.names[int(np.asarray(self._tree.nearest(shapely.Point(np.asarray(xy)))))]

    def free_space(self, radius: float, seed_point: npt.ArrayLike) -> shapely.Polygon:
        """Return the places a disc's centre can reach from one place.

        A room whose walls do not close is cut off `OPEN_ROOM_MARGIN` around all that stands in it.

        Parameters
        ----------
        radius : float
            Radius of the disc [m].
        seed_point : array_like, shape (2,)
            Where the disc is.

        Raises
        ------
        StartError
            If the disc does not fit there.
        """
        seed = shapely.Point(np.asarray(seed_point, dtype=np.float64))
        domain = self._around(seed_point, OPEN_ROOM_MARGIN)
        # GEOS loses whole polygons when it buffers them by next to nothing.
        thick = radius if radius >= _THINNEST else 0.0
        blocked = shapely.buffer(self._union, thick, quad_segs=_QUAD_SEGS)
        for part in shapely.get_parts(shapely.difference(domain, blocked)):
            if shapely.intersects(part, seed):
                return part
        raise StartError(
            f"a robot of radius {radius:g} m does not fit at ({seed.x:.2f}, {seed.y:.2f}): "
            f"{self.nearest_name(seed_point)!r} is in the way; "
            "its centre must be that far from everything"
        )

    def reaches(
        self, xy: npt.ArrayLike, goal: npt.ArrayLike, radius: float
    ) -> npt.NDArray[np.bool_]:
        """Whether a disc of this radius can go from places (..., 2) to the goal (2,).

        Returns
        -------
        ndarray of bool, shape (...)

        Raises
        ------
        StartError
            If the disc does not fit at the goal.
        """
        space = self.free_space(radius, goal)
        places = np.asarray(xy, dtype=np.float64)
        return np.asarray(shapely.intersects_xy(space, places[..., 0], places[..., 1]))

    def interior(self, radius: float, seed_point: npt.ArrayLike) -> BaseGeometry:
        """Return `free_space`, cut near the footprints where the room's walls do not close.

        Use it to choose places; raises as `free_space` does.
        """
        space = self.free_space(radius, seed_point)
        return shapely.intersection(space, self._around(seed_point, 1.0))

    def _around(self, place: npt.ArrayLike, margin: float) -> shapely.Polygon:
        """Return a rectangle around everything and one place more, and a margin [m] around that."""
        everything = shapely.union(self._union, shapely.Point(np.asarray(place)))
        x0, y0, x1, y1 = everything.bounds
        return shapely.box(x0 - margin, y0 - margin, x1 + margin, y1 + margin)

    def sample_free(
        self,
        n: int,
        rng: np.random.Generator,
        radius: float,
        clearance: float,
        goal: npt.ArrayLike,
        min_goal_distance: float,
    ) -> FloatArray:
        """Draw places uniformly from where the goal can be reached.

        The first places are the same however many are asked for.

        Parameters
        ----------
        n : int
            How many.
        rng : numpy.random.Generator
            The only source of randomness.
        radius : float
            Radius of the robot [m].
        clearance : float
            Its perimeter stays farther than this from everything [m].
        goal : array_like, shape (2,)
            The goal.
        min_goal_distance : float
            The robot's centre stays at least this far from it, in a straight line [m].

        Returns
        -------
        ndarray, shape (n, 2)

        Raises
        ------
        StartError
            If the goal is blocked or the room has no such place.
        """
        region = self.interior(radius, goal)
        shapely.prepare(region)
        low, high = np.reshape(region.bounds, (2, 2))
        found = np.zeros((0, 2))
        for _ in range(_MOST_BATCHES):
            if len(found) >= n:
                break
            drawn = rng.uniform(low, high, size=(_BATCH, 2))
            kept = self.suit(drawn, region, radius, clearance, goal, min_goal_distance)
            found = np.concatenate([found, drawn[kept]])
        if len(found) < n:
            raise StartError(
                f"found {len(found)} of {n} places {clearance:g} m clear of everything and "
                f"{min_goal_distance:g} m from the goal, from which a robot of radius {radius:g} m "
                "reaches it; ask for less clearance or distance, or make room"
            )
        return found[:n]

    def suit(
        self,
        places: FloatArray,
        region: BaseGeometry,
        radius: float,
        clearance: float,
        goal: npt.ArrayLike,
        min_goal_distance: float,
    ) -> npt.NDArray[np.bool_]:
        """Return which places (n, 2) in a region can be starts, (n,); else as `sample_free`."""
        kept = shapely.contains_xy(region, places)
        kept &= np.linalg.norm(places - np.asarray(goal), axis=-1) >= min_goal_distance
        kept &= self.clearance(places, radius) > clearance
        return kept
