"""The goal and the obstacles that move in an episode, and the rules they keep."""

import math

import numpy as np
import numpy.typing as npt

from nomad_mj.arenas import FloorPlan
from nomad_mj.errors import StartError
from nomad_mj.movers.bodies import Moving, MovingBody
from nomad_mj.movers.floor import GAP, Floor
from nomad_mj.movers.stroll import Stroll
from nomad_mj.movers.walk import Walk
from nomad_mj.types import FloatArray

ROBOT_GAP = 0.10
"""What an obstacle keeps from the robot, and from where it would stand at the goal [m]."""

START_GAP = 0.5
"""What an obstacle keeps from the robot when an episode starts [m]."""

_TRIED = 4  # starts, when a room is loaded
_MOST_BATCHES = 100


class Movers:
    """Where the goal and the moving obstacles are, from control step to control step.

    An obstacle keeps `ROBOT_GAP` from the robot and never comes nearer of itself: it is the robot
    that bumps into it. It stays in the room, off what stands, off the others and off the goal. The
    goal stays where the robot can go.

    Parameters
    ----------
    moving : Moving
        What moves.
    plan : FloorPlan
        What stands in the room.
    goal : array_like, shape (2,)
        Where the goal starts [m].
    robot_radius : float
        Of the robot's perimeter [m].

    Attributes
    ----------
    goal : ndarray, shape (2,)
        Where the goal is [m]; a new array whenever it moves.
    obstacles : ndarray, shape (n, 2)
        Where the obstacles are [m]; a new array at each step.
    radii : ndarray, shape (n,)
        Of the obstacles [m].

    Raises
    ------
    StartError
        An obstacle of the room's file that stands in something.
    """

    def __init__(
        self, moving: Moving, plan: FloorPlan, goal: npt.ArrayLike, robot_radius: float
    ) -> None:
        self.start_goal = np.array(goal, dtype=np.float64)
        self.goal = self.start_goal
        self.obstacles: FloatArray = np.zeros((len(moving.obstacles), 2))
        self.radii: FloatArray = np.array([body.radius for body in moving.obstacles])
        self._moving = moving
        self._robot_radius = robot_radius
        self._radius: list[float] = self.radii.tolist()
        self._floor = Floor(plan, self.start_goal, self._radius, robot_radius)
        self._robot = (math.inf, math.inf)
        bodies = [*moving.obstacles, *([moving.goal] if moving.goal else [])]
        self.rows = np.array([body.row for body in bodies], dtype=np.intp)
        self._offsets = np.reshape([body.offset for body in bodies], (-1, 2))
        self._check_homes()

    def start(
        self,
        robot: tuple[float, float],
        obstacles_rng: np.random.Generator,
        goal_rng: np.random.Generator,
    ) -> None:
        """Begin an episode: the goal where it starts, the obstacles clear of everything.

        Parameters
        ----------
        robot : (float, float)
            Where the robot's centre is [m].
        obstacles_rng, goal_rng : numpy.random.Generator
            Streams of the episode's own.

        Raises
        ------
        StartError
            There is no place for one of the obstacles.
        """
        self._robot, self.goal = robot, self.start_goal  # the obstacles keep clear of both
        places: list[tuple[float, float]] = []
        for index, body in enumerate(self._moving.obstacles):
            places.append(self._find_place(index, body, places, obstacles_rng))
        bodies = self._moving.obstacles
        drifts = [None if body.walker else body.drift for body in bodies]
        self._walk = Walk(drifts, places, obstacles_rng)
        (free,) = obstacles_rng.spawn(1)
        walkers = [body.walker for body in bodies]
        self._stroll = Stroll(walkers, self._walk.places, self._floor.choose, free)
        self.obstacles = self._walk.array()
        goal = self._moving.goal
        self._goal_walk = Walk([goal.drift], [self.goal], goal_rng) if goal else None

    def advance(self, seconds: float, robot: tuple[float, float]) -> None:
        """Move on, first the goal, then the obstacles one after the other.

        Parameters
        ----------
        seconds : float
            Time that passes.
        robot : (float, float)
            Where the robot's centre is now [m].
        """
        self._robot = robot
        if self._goal_walk is not None:
            self._goal_walk.advance(seconds, self._goal_may_be)
            self.goal = self._goal_walk.array()[0]
        if self._radius:
            self._walk.advance(seconds, self._obstacle_may_be)
            self._stroll.advance(seconds, self._obstacle_may_be)
            self.obstacles = self._walk.array()

    def body_places(self) -> FloatArray:
        """Return where the bodies of `rows` are, (n, 2) or with a goal (n + 1, 2) [m]."""
        if self._goal_walk is None:
            return self.obstacles
        return np.concatenate([self.obstacles, self.goal[None]]) - self._offsets

    def _goal_may_be(self, _: int, x: float, y: float) -> bool:
        if not self._floor.holds_goal(x, y):
            return False
        keep = self._robot_radius + ROBOT_GAP
        return all(
            math.hypot(x - at_x, y - at_y) >= radius + keep
            for (at_x, at_y), radius in zip(self._walk.places, self._radius, strict=True)
        )

    def _obstacle_may_be(self, index: int, x: float, y: float) -> bool:
        radius, places = self._radius[index], self._walk.places
        keep = radius + self._robot_radius + ROBOT_GAP
        robot_x, robot_y = self._robot
        distance = math.hypot(x - robot_x, y - robot_y)
        if distance < keep:  # the robot has come so near: away from it is allowed
            now_x, now_y = places[index]
            if distance <= math.hypot(now_x - robot_x, now_y - robot_y):
                return False
        others = [*places[:index], *places[index + 1 :]]
        radii = [*self._radius[:index], *self._radius[index + 1 :]]
        clear = self._is_clear(radius, (x, y), others, radii)
        return clear and self._floor.holds(index, x, y)

    def _is_clear(
        self,
        radius: float,
        place: tuple[float, float],
        others: list[tuple[float, float]],
        radii: list[float],
    ) -> bool:
        """Whether an obstacle at a place is off the goal and off others."""
        x, y = place
        goal_x, goal_y = self.goal.tolist()
        if math.hypot(x - goal_x, y - goal_y) < radius + self._robot_radius + ROBOT_GAP:
            return False
        return all(
            math.hypot(x - at_x, y - at_y) >= radius + other + GAP
            for (at_x, at_y), other in zip(others, radii, strict=True)
        )

    def _find_place(
        self,
        index: int,
        body: MovingBody,
        others: list[tuple[float, float]],
        rng: np.random.Generator,
    ) -> tuple[float, float]:
        """Return where an obstacle starts: at home if nothing is in the way, else at random."""
        radius, radii = body.radius, self._radius[:index]
        apart = radius + self._robot_radius + START_GAP
        for batch in range(_MOST_BATCHES):
            known = [body.home] if batch == 0 and body.home is not None else []
            on_way = _along(body.walker.way, rng) if body.walker and body.walker.way else None
            for place in (*known, *(on_way or self._floor.draw(index, rng))):
                if math.dist(place, self._robot) >= apart and self._is_clear(
                    radius, place, others, radii
                ):
                    return place
        raise StartError(
            f"no place found for moving obstacle {body.name!r} of radius {radius:g} m, {START_GAP} "
            "m from the robot and clear of everything; take fewer or smaller ones, or make room"
        )

    def _check_homes(self) -> None:
        homes: list[tuple[float, float]] = []
        for index, body in enumerate(self._moving.obstacles):
            if body.home is None:
                continue
            what = f"moving obstacle {body.name!r} of radius {body.radius:g} m"
            if not self._floor.holds(index, *body.home) or not self._is_clear(
                body.radius, body.home, homes, self._radius[: len(homes)]
            ):
                raise StartError(
                    f"{what} at ({body.home[0]:g}, {body.home[1]:g}) is outside the room, in "
                    "something or nearer the goal than a robot that stands there lets it; move it"
                )
            homes.append(body.home)
            way = body.walker.way if body.walker else ()
            for start, end in zip(way, [*way[1:], *way[:1]], strict=True):
                if not self._floor.sees(index, start, end):
                    raise StartError(
                        f"{what} cannot walk straight from ({start[0]:g}, {start[1]:g}) to "
                        f"({end[0]:g}, {end[1]:g}); put another way point in between, or make room"
                    )


def _along(
    way: tuple[tuple[float, float], ...], rng: np.random.Generator
) -> list[tuple[float, float]]:
    """Draw places on the legs of a way."""
    points = np.array(way)
    leg, share = rng.integers(0, len(way), 16), rng.random((16, 1))
    places = points[leg] + share * (points[(leg + 1) % len(way)] - points[leg])
    return [(x, y) for x, y in places.tolist()]


def find_room_for(movers: Movers, starts: FloatArray) -> None:
    """Try whether all that moves finds a place beside a robot at one at least of starts (n, 3).

    Raises
    ------
    StartError
        At none of some, which are spread over them.
    """
    tried: list[list[float]] = starts[:: max(len(starts) // _TRIED, 1)].tolist()
    errors: list[StartError] = []
    for x, y, _ in tried:
        error = _error_at(movers, (x, y))
        if error is None:
            return
        errors.append(error)
    raise errors[0]


def _error_at(movers: Movers, robot: tuple[float, float]) -> StartError | None:
    try:
        movers.start(robot, np.random.default_rng(0), np.random.default_rng(0))
    except StartError as error:
        return error
    return None
