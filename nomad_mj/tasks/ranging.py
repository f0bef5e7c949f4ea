"""Range readings: from how far the obstacles are to what the sensors report."""

from collections.abc import Sequence

import numpy as np

from nomad_mj.robots import RayIndex, RobotDescription
from nomad_mj.tasks.noise import RangeNoise, RangeNoiseStream
from nomad_mj.tasks.sonar import SonarEffects, Sonars
from nomad_mj.types import FloatArray


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
        self._rays, self._count = robot.rays, robot.layout.count
        self._sonars = Sonars(effects, robot) if effects.active else None

    def start(
        self,
        ranges: np.random.Generator,
        crosstalk: np.random.SeedSequence,
        dropout: np.random.SeedSequence,
    ) -> None:
        """Begin an episode with streams of its own."""
        self._noise = RangeNoiseStream(self._config, self._count, ranges)
        if self._sonars is not None:
            self._sonars.start(np.random.default_rng(crosstalk), np.random.default_rng(dropout))

    def read(self, cones: FloatArray) -> FloatArray:
        """Return the readings of this control step, given each cone's shortest ray, (C,) [m]."""
        return self._tell(_within(self._hear(cones) * self._noise.factors(), self._rays))

    def _hear(self, cones: FloatArray) -> FloatArray:
        return cones if self._sonars is None else self._sonars.hear(cones)

    def _tell(self, ranges: FloatArray) -> FloatArray:
        return ranges if self._sonars is None else self._sonars.tell(ranges)

    @staticmethod
    def read_all(robots: "Sequence[Ranging]", cones: FloatArray) -> FloatArray:
        """Return what `read` does for each of N robots with the same options, (N, C) [m].

        Parameters
        ----------
        robots : sequence of Ranging, length N
            Theirs.
        cones : array (N, C)
            Each cone's shortest ray [m].
        """
        plain = robots[0]._sonars is None
        if not plain:
            pairs = zip(robots, cones, strict=True)
            cones = np.array([robot._hear(own) for robot, own in pairs])
        factors = np.array([robot._noise.factors() for robot in robots])
        ranges = _within(cones * factors, robots[0]._rays)
        if not plain:
            pairs = zip(robots, ranges, strict=True)
            ranges = np.array([robot._tell(own) for robot, own in pairs])
        return ranges


def _within(ranges: FloatArray, rays: RayIndex) -> FloatArray:
    """Cut readings (..., C) to what the rings can tell, in place."""
    return np.minimum(np.maximum(ranges, rays.minimum, out=ranges), rays.maximum, out=ranges)
