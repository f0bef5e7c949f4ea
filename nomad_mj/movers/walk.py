"""Discs that drift over a plane: where they are next, and nothing of how that looks."""

import math
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from nomad_mj.movers.drift import Drift
from nomad_mj.types import FloatArray

Allowed = Callable[[int, float, float], bool]


class Walk:
    """Discs on their way, each in its general direction.

    A disc that cannot go on tries the heading mirrored at its general direction; if it cannot go
    there either, it waits for this step and turns its general direction round.

    Parameters
    ----------
    drifts : sequence of Drift or None, length n
        How each disc moves, with a speed that is not None; None for what something else moves.
    places : array_like, shape (n, 2)
        Where the discs are [m].
    rng : numpy.random.Generator
        The only source of randomness.

    Attributes
    ----------
    places : list of (float, float)
        Where the discs are now [m].
    """

    def __init__(
        self, drifts: Sequence[Drift | None], places: npt.ArrayLike, rng: np.random.Generator
    ) -> None:
        self._drifts = [(disc, drift) for disc, drift in enumerate(drifts) if drift]
        self._rng = rng
        self.places: list[tuple[float, float]] = [
            (x, y) for x, y in np.reshape(places, (-1, 2)).astype(np.float64).tolist()
        ]
        count = len(drifts)
        self._course = [drift.direction if drift else 0.0 for drift in drifts]
        self._heading, self._speed, self._left = [0.0] * count, [0.0] * count, [0.0] * count
        for disc, drift in self._drifts:
            self._draw(disc, drift)
            self._left[disc] = rng.uniform(0.0, drift.period)  # or all would turn at once

    def array(self) -> FloatArray:
        """Return the places, (n, 2) [m], as an array of their own."""
        return np.reshape(np.array(self.places, dtype=np.float64), (-1, 2))

    def advance(self, seconds: float, allowed: Allowed) -> None:
        """Move every disc on, one after the other.

        Parameters
        ----------
        seconds : float
            Time that passes.
        allowed : callable
            Whether the disc of an index may be at x, y [m], as all others are now.
        """
        for disc, drift in self._drifts:
            x, y = self.places[disc]
            self._left[disc] -= seconds
            if self._left[disc] <= 0:
                self._draw(disc, drift)
            step = self._speed[disc] * seconds
            heading = self._heading[disc]
            for way in (heading, 2 * self._course[disc] - heading):
                to = x + step * math.cos(way), y + step * math.sin(way)
                if allowed(disc, *to):
                    self.places[disc], self._heading[disc] = to, way
                    break
            else:
                self._course[disc] += math.pi
                self._draw(disc, drift)

    def _draw(self, disc: int, drift: Drift) -> None:
        """Draw speed and heading of the next period."""
        assert drift.speed is not None
        speed, sideways = self._rng.uniform((0.0, -drift.spread), (drift.speed, drift.spread))
        self._speed[disc] = float(speed)
        self._heading[disc] = self._course[disc] + float(sideways)
        self._left[disc] = drift.period
