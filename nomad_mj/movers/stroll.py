"""How people walk about: from one place straight to the next, with a pause now and then."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from nomad_mj.movers.drift import MovingObstacles, check_number
from nomad_mj.movers.walk import Allowed

Place: TypeAlias = tuple[float, float]
Choose: TypeAlias = Callable[[int, Place, np.random.Generator], "Place | None"]

PATIENCE = (1.0, 3.0)
"""A walker that is in front of something waits for a time between these [s]."""


@dataclass(frozen=True)
class Walker:
    """How one person walks.

    Attributes
    ----------
    speed : float
        While walking [m/s].
    pause : float
        Longest rest at a way point [s]; how long is drawn each time.
    way : tuple of (float, float)
        Way points [m], walked round and round, the first one home; without them it goes from
        anywhere to anywhere.
    """

    speed: float
    pause: float = 0.0
    way: tuple[Place, ...] = ()


@dataclass(frozen=True)
class Walkers(MovingObstacles):
    """People who walk about in the room, from anywhere straight to anywhere in sight.

    What drifts has a `direction`, a `spread` and a `period`; these mean nothing here.

    Attributes
    ----------
    count : int
        How many.
    speed : float or None
        While walking [m/s]; None for half of the robot's top speed.
    pause : float
        Longest rest where they arrive [s].
    radius, height : float
        Of each [m].
    """

    speed: float | None = 0.6
    count: int = 3
    height: float = 1.7
    pause: float = 2.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.pause != 0:
            check_number("pause of walkers", self.pause, 0, " s: must be 0 or more")


class Stroll:
    """Walkers on their way.

    A walker goes straight to its next way point. Before something in its way it waits for a
    while, then turns round: back along its way, or to anywhere else if it has none.

    Parameters
    ----------
    walkers : sequence of Walker or None, length n
        Who walks; None for a disc that something else moves.
    places : list of (float, float), length n
        Where all discs are [m]; those of walkers are changed in place.
    choose : callable
        A place that the disc of an index can go to straight from a place, or None.
    rng : numpy.random.Generator
        The only source of randomness.
    """

    def __init__(
        self,
        walkers: Sequence[Walker | None],
        places: list[Place],
        choose: Choose,
        rng: np.random.Generator,
    ) -> None:
        self._walkers = [(index, walker) for index, walker in enumerate(walkers) if walker]
        self._places, self._choose, self._rng = places, choose, rng
        count = len(walkers)
        self._rest, self._wait = [0.0] * count, [0.0] * count
        self._next, self._sense = [0] * count, [1] * count
        self._target: list[Place | None] = [None] * count
        for index, walker in self._walkers:
            self._wait[index] = self._patience()
            if walker.way:
                self._next[index] = leg_of(walker.way, places[index])
            self._go_on(index, walker)

    def advance(self, seconds: float, allowed: Allowed) -> None:
        """Move every walker on, one after the other; see `Walk.advance`."""
        for index, walker in self._walkers:
            target = self._target[index]
            if self._rest[index] > 0:
                self._rest[index] -= seconds
            elif target is None:
                self._go_on(index, walker)
            else:
                self._walk(index, walker, target, seconds, allowed)

    def _walk(
        self, index: int, walker: Walker, target: Place, seconds: float, allowed: Allowed
    ) -> None:
        x, y = self._places[index]
        left = math.hypot(target[0] - x, target[1] - y)
        share = min(1.0, walker.speed * seconds / left) if left else 1.0
        to = (x + share * (target[0] - x), y + share * (target[1] - y)) if share < 1 else target
        if allowed(index, *to):
            self._places[index] = to
            self._wait[index] = max(self._wait[index], PATIENCE[0])
            if share == 1:
                self._rest[index] = float(self._rng.uniform(0.0, walker.pause))
                self._go_on(index, walker)
            return
        self._wait[index] -= seconds
        if self._wait[index] <= 0:
            self._wait[index] = self._patience()
            self._sense[index] *= -1
            self._go_on(index, walker)

    def _go_on(self, index: int, walker: Walker) -> None:
        """Turn to the next way point."""
        if walker.way:
            self._next[index] = (self._next[index] + self._sense[index]) % len(walker.way)
            self._target[index] = walker.way[self._next[index]]
        else:
            self._target[index] = self._choose(index, self._places[index], self._rng)

    def _patience(self) -> float:
        return float(self._rng.uniform(*PATIENCE))


def leg_of(way: Sequence[Place], place: Place) -> int:
    """Return the number of the way point at which the leg begins that is nearest to a place."""
    gaps: list[float] = []
    for (x, y), (next_x, next_y) in zip(way, [*way[1:], way[0]], strict=True):
        along_x, along_y = next_x - x, next_y - y
        length = along_x**2 + along_y**2
        share = ((place[0] - x) * along_x + (place[1] - y) * along_y) / length if length else 0.0
        share = min(max(share, 0.0), 1.0)
        gaps.append(math.hypot(place[0] - x - share * along_x, place[1] - y - share * along_y))
    return gaps.index(min(gaps))
