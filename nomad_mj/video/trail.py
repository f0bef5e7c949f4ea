"""The path driven so far, thinned to the points that matter."""

import numpy as np

from nomad_mj.types import FloatArray
from nomad_mj.video.palette import GREY, RGB

_STRAIGHT = 0.01  # [m] that a straight piece may stray
_AIM = 0.1  # [m] after which the direction of a straight piece is known
_STILL = 1e-3  # [m]


class Trail:
    """A polyline that grows as the robot drives.

    Parameters
    ----------
    place : array (2,)
        Where it begins [m].

    Attributes
    ----------
    colour : RGB
        Of what is driven from now on.
    stops : list of (place (2,), RGB)
        Places to mark with a dot.
    """

    def __init__(self, place: FloatArray) -> None:
        self.colour: RGB = GREY
        self.stops: list[tuple[FloatArray, RGB]] = []
        self._points: list[FloatArray] = [place, place]
        self._colours: list[RGB] = [GREY]
        self._aim: FloatArray | None = None

    def stop(self, colour: RGB) -> None:
        """Mark the present place and go on in another colour."""
        self.colour = colour
        self.stops.append((self._points[-1], colour))
        self._turn()

    def extend(self, place: FloatArray) -> None:
        """Drive on to a place (2,) [m]."""
        anchor, last = self._points[-2:]
        step = place - last
        if float(np.hypot(step[0], step[1])) < _STILL:
            return
        span = place - anchor
        if self._aim is not None:
            astray = abs(float(self._aim[0] * span[1] - self._aim[1] * span[0]))
            if astray > _STRAIGHT or float(step @ self._aim) < 0:
                self._turn()
        elif float(step @ (last - anchor)) < 0:
            self._turn()
        self._points[-1] = place
        self._colours[-1] = self.colour
        span = place - self._points[-2]
        length = float(np.hypot(span[0], span[1]))
        if self._aim is None and length >= _AIM:
            self._aim = span / length

    def _turn(self) -> None:
        """Begin a new straight piece where the last one ends."""
        self._points.append(self._points[-1])
        self._colours.append(self.colour)
        self._aim = None

    def bends(self) -> tuple[FloatArray, list[RGB]]:
        """Return where the path bends, (N, 2), and the N - 1 colours in between."""
        return np.reshape(self._points[:-1], (-1, 2)), self._colours[:-1]

    @property
    def tail(self) -> tuple[FloatArray, RGB]:
        """The last bend, from which the path leads straight to the robot, and its colour."""
        return self._points[-2], self.colour
