"""Crosstalk: a sonar takes the echo of another one's pulse for that of its own."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nomad_mj.errors import ConfigError
from nomad_mj.option_types import check_fields
from nomad_mj.types import FloatArray, IntArray

_SLACK = 1e-6  # [rad]


@dataclass(frozen=True)
class Crosstalk:
    """How sonars that fire in the same control step disturb each other.

    All pulses sound alike. One that comes back to another sonar has travelled from the first to the
    obstacle and on to the second; if that way is shorter than the second's own, it reads half of
    it, nearer than anything that is there (J. Borenstein and Y. Koren, "Error eliminating rapid
    ultrasonic firing for mobile robot obstacle avoidance", IEEE Trans. Robotics and Automation 11
    (1995), who fire in an order in which this is rare and can be told). Every obstacle counts as
    lying on the axis of the cone that found it. Echoes that arrive a step late are left out.

    Attributes
    ----------
    probability : float
        With which a cone, when it fires, hears the pulses of the others, in [0, 1].
    reach : float
        It hears those whose axes point no farther from its own than this [rad]; by default two
        neighbours of sixteen on either side.
    """

    probability: float = 0.1
    reach: float = math.pi / 4

    def __post_init__(self) -> None:
        check_fields(self)
        if not 0 <= self.probability <= 1:
            raise ConfigError(f"crosstalk probability {self.probability}: must be in [0, 1]")
        if not 0 < self.reach <= math.pi:
            raise ConfigError(f"crosstalk reach {self.reach}: must be in (0, pi] rad")


class Echoes:
    """The ways of pulses from one cone, by the obstacle it faces, to another.

    Parameters
    ----------
    bearings : array (C,)
        Axes of the cones [rad].
    offset : array (C,)
        From each cone's site out to the robot's perimeter [m].
    radius : float
        Of the perimeter [m].
    """

    def __init__(self, bearings: FloatArray, offset: FloatArray, radius: float) -> None:
        self._axes: FloatArray = np.stack([np.cos(bearings), np.sin(bearings)], axis=-1)
        self._offset, self._radius = offset, radius
        self._sites = (radius - offset)[:, None] * self._axes

    def readings(self, ranges: FloatArray, ears: IntArray) -> FloatArray:
        """Return what the cones `ears` (E,) read of each cone's pulse, (E, C) [m].

        Parameters
        ----------
        ranges : array (C,)
            How far each cone's obstacle is from the perimeter [m].
        ears : array (E,)
            Numbers of the cones that listen.
        """
        obstacles = (self._radius + ranges)[:, None] * self._axes
        back = obstacles[None, :] - self._sites[ears, None]
        way = ranges + self._offset + np.sqrt((back * back).sum(axis=-1))
        return way / 2 - self._offset[ears, None]


def within_reach(bearings: FloatArray, reach: float) -> npt.NDArray[np.bool_]:
    """Return which cones hear which, (C, C): others whose axes are near enough."""
    apart = np.abs((bearings[:, None] - bearings + np.pi) % (2 * np.pi) - np.pi)
    return (apart <= reach + _SLACK) & ~np.eye(len(bearings), dtype=bool)
