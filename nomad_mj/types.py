"""Plain data shared by the simulation and the agents: no physics, no behaviour."""

import math
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]
IntArray: TypeAlias = npt.NDArray[np.intp]


class Pose(NamedTuple):
    """A place in the plane: `x`, `y` [m] in the world frame and `heading` [rad], 0 along +x."""

    x: float
    y: float
    heading: float


@dataclass(frozen=True)
class RangeRing:
    """A ring of range sensors of one kind.

    Attributes
    ----------
    name : str
        Name of the ring, e.g. ``"sonar"``.
    bearings : tuple of float
        Direction of each sensor's axis in the ring's frame [rad].
    half_angle : float
        Half the opening of a sensor's cone [rad].
    min_range, max_range : float
        Readings lie in this interval [m], from the robot's perimeter; a miss reads `max_range`.
    """

    name: str
    bearings: tuple[float, ...]
    half_angle: float
    min_range: float
    max_range: float


@dataclass(frozen=True)
class SensorLayout:
    """What perception has to know of a robot: its size and its rings of range sensors.

    Attributes
    ----------
    radius : float
        Radius of the robot's perimeter [m].
    rings : tuple of RangeRing
        In the order in which their readings are concatenated.
    """

    radius: float
    rings: tuple[RangeRing, ...]

    @property
    def count(self) -> int:
        """Number of range sensors in all rings together."""
        return sum(len(ring.bearings) for ring in self.rings)

    @property
    def least_readings(self) -> FloatArray:
        """Least that any sensor reads of what is straight before each sensor, (count,) [m].

        Those count whose cones the axis of that sensor lies in: its own, and others'.
        """
        sizes = [len(ring.bearings) for ring in self.rings]
        bearings = np.concatenate([ring.bearings for ring in self.rings])
        half_angle = np.repeat([ring.half_angle for ring in self.rings], sizes)
        least = np.repeat([ring.min_range for ring in self.rings], sizes)
        apart = np.abs((bearings[:, None] - bearings + math.pi) % math.tau - math.pi)
        # The last bits of bearings differ from processor to processor.
        return np.where(apart <= half_angle + 1e-6, least, np.inf).min(axis=1)

    def matches(self, other: "SensorLayout") -> bool:
        """Return whether both are the same sensors, but for rounding.

        Numbers that come out of the engine differ in their last bits from processor to processor.
        """
        if [(r.name, len(r.bearings)) for r in self.rings] != [
            (r.name, len(r.bearings)) for r in other.rings
        ]:
            return False
        mine, theirs = self._numbers(), other._numbers()
        return all(math.isclose(a, b, abs_tol=1e-9) for a, b in zip(mine, theirs, strict=True))

    def _numbers(self) -> list[float]:
        rings = [(*r.bearings, r.half_angle, r.min_range, r.max_range) for r in self.rings]
        return [self.radius, *(number for ring in rings for number in ring)]


@dataclass(frozen=True)
class MotionLimits:
    """Largest speeds and accelerations of a robot.

    Attributes
    ----------
    translate, translate_acceleration : float
        Driving [m/s], [m/s2].
    turn, turn_acceleration : float
        Changing the direction of driving: turning the wheels of a synchro drive, else the robot
        [rad/s], [rad/s2].
    """

    translate: float
    translate_acceleration: float
    turn: float
    turn_acceleration: float


class Travel(NamedTuple):
    """What the encoders tell of one control step, without any drift.

    Attributes
    ----------
    forward, sideways : float
        Way along the robot's heading and to the left of it [m].
    heading : float
        Direction in which the robot drives when it drives forward [rad], world frame.
    sensors : float
        Direction of the frame of the range sensors [rad], world frame.
    """

    forward: float
    sideways: float
    heading: float
    sensors: float
