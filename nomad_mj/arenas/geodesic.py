"""Shortest paths of a disc to a goal, by visibility graph."""

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry.polygon import orient

from nomad_mj.arenas.floor_plan import FloorPlan
from nomad_mj.errors import StartError
from nomad_mj.types import FloatArray, IntArray

_SLACK = 1e-6  # [m]: sight lines may graze the boundary they run along
_GRAZE = 1e-10  # [m2], what rounding makes of a line along a wall of a hundred metres
_CHUNK = 1_000_000  # pairs of point and corner looked at together
_TRIES = 8  # ways from a point that are looked at first, the shortest ones


class Geodesic:
    """Length and course of the shortest paths to one goal, for a disc-shaped robot.

    The paths are exact for the plan's polygons, whose corners the disc rounds in steps of 11.25
    degrees: less than 0.5 % of its radius too short at each corner. They are those of the
    visibility graph over the corners of the free space (Lozano-Perez and Wesley 1979), of which
    only the edges that leave a corner as a tangent can be part of a shortest path.

    Parameters
    ----------
    plan : FloorPlan
        The room.
    goal : array_like, shape (2,)
        Where the disc's centre is to go, world frame [m].
    radius : float
        Radius of the disc [m].

    Raises
    ------
    StartError
        If the disc does not fit at the goal.
    """

    def __init__(self, plan: FloorPlan, goal: npt.ArrayLike, radius: float) -> None:
        self.goal = np.asarray(goal, dtype=np.float64)
        self.radius = radius
        space = plan.free_space(radius, self.goal)
        self._corners, self._before, self._after = _corners(space)
        self._space = shapely.buffer(space, _SLACK, join_style="mitre")
        shapely.prepare(self._space)
        # Whether a line meets what is not free is told ten times faster than whether it is inside.
        around = shapely.box(*shapely.bounds(self._space)).buffer(1.0, join_style="mitre")
        self._blocked = shapely.difference(around, self._space)
        shapely.prepare(self._blocked)
        self._distance, self._next = self._to_goal()

    def length(self, points: npt.ArrayLike) -> FloatArray:
        """Return the lengths of the shortest paths to the goal.

        Parameters
        ----------
        points : array_like, shape (..., 2)
            Where the disc's centre starts, world frame [m].

        Returns
        -------
        ndarray, shape (...)
            In metres; infinite where the disc does not fit or the goal cannot be reached.
        """
        starts = np.asarray(points, dtype=np.float64)
        return self._solve(starts.reshape(-1, 2))[0].reshape(starts.shape[:-1])

    def path(self, point: npt.ArrayLike) -> FloatArray:
        """Return the corners (K, 2) of the shortest path, from `point` (2,) to the goal.

        Raises
        ------
        StartError
            If there is none.
        """
        start = np.asarray(point, dtype=np.float64)
        length, first = self._solve(start[None])
        if not np.isfinite(length[0]):
            raise StartError(
                f"no path for a robot of radius {self.radius:g} m from "
                f"({start[0]:.2f}, {start[1]:.2f}) to the goal at "
                f"({self.goal[0]:.2f}, {self.goal[1]:.2f}); move one of them or open a passage"
            )
        course = [start]
        node = int(first[0])
        while node != len(self._corners):
            course.append(self._corners[node])
            node = int(self._next[node])
        return np.array([*course, self.goal])

    def _to_goal(self) -> tuple[FloatArray, IntArray]:
        """Distance of every corner, then the goal, to the goal, and the node that comes next."""
        # Here, and not above: to import it takes as long as all the rest of nomad_mj.
        from scipy import sparse
        from scipy.sparse import csgraph

        count = len(self._corners)
        source, target = self._pairs()
        at_goal = np.flatnonzero(self._tangent(self.goal[None])[0])
        source = np.concatenate([source, at_goal])
        target = np.concatenate([target, np.full(len(at_goal), count)])
        nodes = np.concatenate([self._corners, self.goal[None]])
        seen = self._sees(nodes[source], nodes[target])
        source, target = source[seen], target[seen]
        weight = np.linalg.norm(nodes[source] - nodes[target], axis=-1)
        graph = sparse.csr_array((weight, (source, target)), shape=(count + 1, count + 1))
        distance, following = csgraph.dijkstra(
            graph, directed=False, indices=count, return_predecessors=True
        )
        return np.asarray(distance), np.asarray(following)

    def _pairs(self) -> tuple[IntArray, IntArray]:
        """Return the pairs of corners, the lower number first, whose line is a tangent at both."""
        count = len(self._corners)
        rows = max(1, _CHUNK // (count + 1))
        found = [np.zeros((0, 2), dtype=np.intp)]
        for first in range(0, count, rows):
            last = min(first + rows, count)
            there = self._tangent(self._corners[first:last], first)
            back = self._tangent(self._corners[first:], first, last).T
            found.append(np.argwhere(np.triu(there & back, k=1)) + first)
        source, target = np.concatenate(found).T
        return source, target

    def _solve(self, points: FloatArray) -> tuple[FloatArray, IntArray]:
        """Length of each path (N,) and the node it makes for first (N,), corner or goal."""
        size = max(1, _CHUNK // (len(self._corners) + 1))
        parts = [self._solve_some(points[i : i + size]) for i in range(0, len(points), size)]
        if not parts:
            return np.zeros(0), np.zeros(0, dtype=np.intp)
        return np.concatenate([p[0] for p in parts]), np.concatenate([p[1] for p in parts])

    def _solve_some(self, points: FloatArray) -> tuple[FloatArray, IntArray]:
        count = len(self._corners)
        length = np.full((len(points), count + 1), np.inf)
        fits = shapely.intersects_xy(self._space, points)
        sight = fits & self._sees(points, np.broadcast_to(self.goal, points.shape))
        length[sight, count] = np.linalg.norm(points[sight] - self.goal, axis=-1)
        leg = np.linalg.norm(self._corners - points[:, None], axis=-1)
        candidates = self._tangent(points) & (fits & ~sight)[:, None]
        ways = np.where(candidates, leg + self._distance[:count], np.inf)
        order = np.argsort(ways, axis=1)
        todo, first, tries = np.flatnonzero(np.isfinite(ways).any(axis=1)), 0, _TRIES
        while len(todo) and first < count:
            corner = order[todo, first : first + tries]
            way = ways[todo[:, None], corner]
            row, column = np.nonzero(np.isfinite(way))
            seen = self._sees(points[todo[row]], self._corners[corner[row, column]])
            row, column = row[seen], column[seen]
            length[todo[row], corner[row, column]] = way[row, column]
            # The first that is seen is the shortest: all that come later are longer.
            done = np.zeros(len(todo), dtype=np.bool_)
            done[row] = True
            first, tries, todo = first + tries, 2 * tries, todo[~done & np.isfinite(way[:, -1])]
        return length.min(axis=1), length.argmin(axis=1)

    def _tangent(
        self, points: FloatArray, first: int = 0, last: int | None = None
    ) -> npt.NDArray[np.bool_]:
        """Whether lines from points (N, 2) to corners (V, 2) touch these without cutting them.

        Of the corners those from number `first` to before `last` are looked at.
        """
        sides: list[FloatArray] = []
        for way in (self._before[first:last], self._after[first:last]):
            # The cross product of line and way, as a product of matrices.
            across = np.stack([way[:, 1], -way[:, 0]])
            here = self._corners[first:last] - self.goal
            sides.append(_cross(here, way) - (points - self.goal) @ across)
        # One too many is seen through later, one too few would be a way that is missing.
        return sides[0] * sides[1] >= -_GRAZE

    def _sees(self, start: FloatArray, end: FloatArray) -> npt.NDArray[np.bool_]:
        """Whether the straight lines between two arrays of points (M, 2) stay in the free space."""
        lines = shapely.linestrings(np.stack([start, end], axis=1))
        return ~np.asarray(shapely.intersects(self._blocked, lines))


def _corners(space: shapely.Polygon) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the corners a path can bend around (V, 2), and the way to their two neighbours."""
    # Points that all but coincide give their edges directions that mean nothing.
    clean = shapely.remove_repeated_points(space, _SLACK / 10)
    oriented = orient(clean)  # the free space lies to the left of every ring
    corners: list[FloatArray] = []
    before: list[FloatArray] = []
    after: list[FloatArray] = []
    for ring in (oriented.exterior, *oriented.interiors):
        points = shapely.get_coordinates(ring)[:-1]
        back, ahead = np.roll(points, 1, axis=0) - points, np.roll(points, -1, axis=0) - points
        bends = _cross(-back, ahead) < 0
        corners.append(points[bends])
        before.append(_unit(back[bends]))
        after.append(_unit(ahead[bends]))
    return np.concatenate(corners), np.concatenate(before), np.concatenate(after)


def _unit(ways: FloatArray) -> FloatArray:
    return ways / np.linalg.norm(ways, axis=-1, keepdims=True)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
