"""Odometry: the robot's own idea of where it is, integrated from its encoders."""

import math

import numpy as np

from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.tasks.noise import OdometryNoise
from nomad_mj.types import FloatArray, Pose, Travel


class Odometry:
    """Dead reckoning, apart from the true pose.

    Parameters
    ----------
    start : Pose
        Where the robot knows it starts.
    noise : OdometryNoise
        How it errs.
    rng : numpy.random.Generator
        Stream of the errors.
    weight : float
        Of the turns that a gyroscope measures against those of the encoders.
    """

    def __init__(
        self, start: Pose, noise: OdometryNoise, rng: np.random.Generator, weight: float = 0.0
    ) -> None:
        self._noise = noise
        self._rng = rng
        self._drifts = noise.distance > 0 or noise.heading > 0
        self.x, self.y, self.heading, self.sensors = start.x, start.y, start.heading, 0.0
        self._drift = 0.0
        self._creeps = noise.heading_per_metre != 0 or noise.heading_per_second != 0
        self._weight, self._told = weight, start.heading
        self._began = False

    def update(self, travel: Travel, turned: float | None = None) -> None:
        """Take in a control step as the encoders tell it.

        The first one is no step, but where the robot finds itself.

        Parameters
        ----------
        travel : Travel
            What the encoders tell.
        turned : float, optional
            The turn in this step by a gyroscope [rad], None if there is none.
        """
        forward, sideways, heading, sensors = travel
        drift = 0.0
        if self._drifts and (forward or sideways):
            error, turn = self._rng.normal(size=2).tolist()
            way = math.hypot(forward, sideways)
            root = math.sqrt(way)  # variances add up, whatever the length of a step
            share = 1.0 + self._noise.distance * error * root / way
            forward, sideways = share * forward, share * sideways
            drift = self._noise.heading * turn * root
        if self._creeps and self._began:
            drift += self._noise.heading_per_metre * travel.forward
            drift += self._noise.heading_per_second * CONTROL_TIMESTEP
        if turned is not None and self._began:  # the encoders say: turned by heading - told + drift
            drift += self._weight * (turned - (heading - self._told) - drift)
        self._told, self._began = heading, True
        self._drift += drift
        heading += self._drift
        middle = (self.heading + heading) / 2
        self.x += forward * math.cos(middle)
        self.y += forward * math.sin(middle)
        if sideways:
            self.x -= sideways * math.sin(middle)
            self.y += sideways * math.cos(middle)
        self.heading = heading
        self.sensors = sensors + self._drift

    def reading(self) -> FloatArray:
        """Return x, y [m], heading of the robot and of its range sensors [rad], (4,)."""
        return np.array(self.told())

    def told(self) -> tuple[float, float, float, float]:
        """Return the same as plain numbers."""
        x, y = self.x, self.y
        if self._noise.position > 0:
            wrong = self._rng.uniform(-self._noise.position, self._noise.position, 2).tolist()
            x, y = x + wrong[0], y + wrong[1]
        return x, y, self.heading, self.sensors
