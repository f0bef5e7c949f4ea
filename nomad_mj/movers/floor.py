"""Where moving obstacles and a moving goal can be in a room, whatever else moves there."""

import math

import numpy as np
import shapely

from nomad_mj.arenas import FloorPlan
from nomad_mj.types import FloatArray

GAP = 0.02
"""What an obstacle keeps from walls, from what stands and from other moving obstacles [m]."""

GOAL_CLEARANCE = 0.12
"""What a moving goal leaves a robot that stands there [m], or as much as it does at its start."""

_SHORTEST = 1.0  # way of a walker to a place at random [m]
_DRAWN = 64


class Floor:
    """The part of the floor that each obstacle, and the goal, can move on.

    Parameters
    ----------
    plan : FloorPlan
        What stands in the room.
    goal : ndarray, shape (2,)
        Where the goal starts [m].
    radii : list of float
        Of the obstacles [m].
    robot_radius : float
        Of the robot's perimeter [m].
    """

    def __init__(
        self, plan: FloorPlan, goal: FloatArray, radii: list[float], robot_radius: float
    ) -> None:
        floor = plan.free_space(0.0, goal)
        made = {radius: shapely.buffer(floor, -(radius + GAP)) for radius in set(radii)}
        spare = min(GOAL_CLEARANCE, 0.99 * float(plan.clearance(goal, robot_radius)))
        self._goal = plan.free_space(robot_radius + max(spare, 0.0), goal)
        for space in (*made.values(), self._goal):
            shapely.prepare(space)
        self._rooms = [made[radius] for radius in radii]
        box = plan.interior(0.0, goal) if plan.footprints else floor
        self._box = np.reshape(box.bounds, (2, 2))

    def holds(self, obstacle: int, x: float, y: float) -> bool:
        """Whether the obstacle of a number can be at x, y [m]."""
        return bool(shapely.intersects_xy(self._rooms[obstacle], x, y))

    def holds_goal(self, x: float, y: float) -> bool:
        """Whether the goal can be at x, y [m]."""
        return bool(shapely.intersects_xy(self._goal, x, y))

    def sees(self, obstacle: int, start: tuple[float, float], end: tuple[float, float]) -> bool:
        """Whether an obstacle can go straight from one place to another [m]."""
        line = shapely.LineString([start, end])
        return bool(shapely.covers(self._rooms[obstacle], line))

    def draw(self, obstacle: int, rng: np.random.Generator) -> list[tuple[float, float]]:
        """Draw places at which an obstacle can be, up to 64, as likely everywhere [m]."""
        low, high = self._box
        places = rng.uniform(low, high, (_DRAWN, 2))
        places = places[shapely.intersects_xy(self._rooms[obstacle], places)]
        return [(x, y) for x, y in places.tolist()]

    def choose(
        self, obstacle: int, place: tuple[float, float], rng: np.random.Generator
    ) -> tuple[float, float] | None:
        """Draw a place to which an obstacle can go straight from another; None if none is found."""
        for to in self.draw(obstacle, rng):
            if math.dist(place, to) >= _SHORTEST and self.sees(obstacle, place, to):
                return to
        return None
