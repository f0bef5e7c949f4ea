"""Range readings: from how far the obstacles are to what the sensors report."""

import numpy as np

from nomad_mj.robots import RobotDescription
from nomad_mj.tasks.noise import RangeNoise, RangeNoiseStream
from nomad_mj.tasks.physics import NavigationPhysics
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

    def read(self, physics: NavigationPhysics) -> FloatArray:
        """Return the readings of this control step, (C,) [m]."""
        rays, sonars = self._rays, self._sonars
        ranges = physics.cone_ranges()
        if sonars is not None:
            ranges = sonars.hear(ranges)
        ranges = ranges * self._noise.factors()
        np.minimum(np.maximum(ranges, rays.minimum, out=ranges), rays.maximum, out=ranges)
        return ranges if sonars is None else sonars.tell(ranges)
