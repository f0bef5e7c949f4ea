"""Range readings: from how far the obstacles are to what the sensors report."""

from collections.abc import Sequence

import numpy as np

from nomad_mj.robots import RayIndex, RobotDescription
from nomad_mj.tasks.noise import RangeNoise, RangeNoiseStream, RangeNoiseStreams
from nomad_mj.tasks.sonar import SonarEffects, Sonars
from nomad_mj.types import FloatArray, IntArray


class Ranging:
    """The range sensors of a robot, all rings concatenated.

    What each does to a reading, one after another: light that comes back (`InfraredEffects`) and
    echoes that do not (`RangeNoise.grazing`), both in the physics, since they go by the ray;
    limits and crosstalk; noise; the ring's limits; dropouts; turns.

    Parameters
    ----------
    noise : RangeNoise
        How readings err.
    effects : SonarEffects
        What else sonars suffer.
    robot : RobotDescription
        The robot.
    """

    def __init__(self, noise: RangeNoise, effects: SonarEffects, robot: RobotDescription) -> None:
        self._config = noise
        self.rays, self.count = robot.rays, robot.layout.count
        self.sonars = Sonars(effects, robot) if effects.active else None

    def start(
        self,
        ranges: np.random.Generator,
        crosstalk: np.random.SeedSequence,
        dropout: np.random.SeedSequence,
    ) -> None:
        """Begin an episode with streams of its own."""
        self.noise = RangeNoiseStream(self._config, self.count, ranges)
        if self.sonars is not None:
            self.sonars.start(np.random.default_rng(crosstalk), np.random.default_rng(dropout))

    def read(self, cones: FloatArray) -> FloatArray:
        """Return the readings of this control step, given each cone's shortest ray, (C,) [m]."""
        return self.tell(_within(self.hear(cones) * self.noise.factors(), self.rays))

    def hear(self, cones: FloatArray) -> FloatArray:
        """Return what is heard before noise, (C,) [m]."""
        return cones if self.sonars is None else self.sonars.hear(cones)

    def tell(self, ranges: FloatArray) -> FloatArray:
        """Return what is told of noisy readings, (C,) [m]."""
        return ranges if self.sonars is None else self.sonars.tell(ranges)


class RangingOfMany:
    """The range sensors of N robots under the same options, read at once.

    Parameters
    ----------
    robots : sequence of Ranging, length N
        Each by itself; their streams are drawn from here once `go_on` has been called.
    """

    def __init__(self, robots: Sequence[Ranging]) -> None:
        self._robots = robots
        self._rays = robots[0].rays
        self._affected = robots[0].sonars is not None
        self._noise = RangeNoiseStreams(len(robots), robots[0].count)

    def go_on(self, number: int) -> None:
        """Take over the episode of a robot, from where it is by itself."""
        self._noise.go_on(number, self._robots[number].noise)

    def read(self, numbers: IntArray, cones: FloatArray) -> FloatArray:
        """Return what `Ranging.read` does for each of some robots (n,), (n, C) [m].

        Parameters
        ----------
        numbers : array (n,)
            Which robots.
        cones : array (n, C)
            Each cone's shortest ray [m].
        """
        robots = [self._robots[number] for number in numbers.tolist()] if self._affected else []
        if robots:
            pairs = zip(robots, cones, strict=True)
            cones = np.array([robot.hear(own) for robot, own in pairs])
        ranges = _within(cones * self._noise.factors(numbers), self._rays)
        if robots:
            pairs = zip(robots, ranges, strict=True)
            ranges = np.array([robot.tell(own) for robot, own in pairs])
        return ranges


def _within(ranges: FloatArray, rays: RayIndex) -> FloatArray:
    """Cut readings (..., C) to what the rings can tell, in place."""
    return np.minimum(np.maximum(ranges, rays.minimum, out=ranges), rays.maximum, out=ranges)
