"""Odometry: the robot's own idea of where it is, integrated from its encoders."""

import math

import numpy as np

from nomad_mj.tasks.noise import OdometryNoise
from nomad_mj.types import FloatArray, Pose


class Odometry:
    """Dead reckoning of a synchro drive, apart from the true pose.

    Parameters
    ----------
    start : Pose
        Where the robot knows it starts.
    noise : OdometryNoise
        How it errs.
    rng : numpy.random.Generator
        Stream of the errors.
    """

    def __init__(self, start: Pose, noise: OdometryNoise, rng: np.random.Generator) -> None:
        self._noise = noise
        self._rng = rng
        self._drifts = noise.distance > 0 or noise.heading > 0
        self.x, self.y, self.heading, self.turret = start.x, start.y, start.heading, 0.0
        self._drift = 0.0

    def update(self, distance: float, steer: float, turret: float) -> None:
        """Take in a control step: distance driven [m], wheels' and turret's angle [rad]."""
        if self._drifts and distance:
            error, turn = self._rng.normal(size=2).tolist()
            root = math.sqrt(abs(distance))  # variances add up, whatever the length of a step
            distance += self._noise.distance * error * root
            self._drift += self._noise.heading * turn * root
        heading = steer + self._drift
        middle = (self.heading + heading) / 2
        self.x += distance * math.cos(middle)
        self.y += distance * math.sin(middle)
        self.heading = heading
        self.turret = turret + self._drift

    def reading(self) -> FloatArray:
        """Return x, y [m], heading of the wheels and of the turret [rad], (4,)."""
        reading = np.array([self.x, self.y, self.heading, self.turret])
        if self._noise.position > 0:
            reading[:2] += self._rng.uniform(-self._noise.position, self._noise.position, 2)
        return reading
