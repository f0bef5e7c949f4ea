"""What a robot senses of itself in an episode: its way, its turns, its contacts."""

from collections.abc import Callable, Sequence

import numpy as np

from nomad_mj.robots import RobotDescription
from nomad_mj.tasks.bumpers import StickyBumpers
from nomad_mj.tasks.config import MotorConfig
from nomad_mj.tasks.gyroscope import GyroscopeStream
from nomad_mj.tasks.odometry import Odometry
from nomad_mj.types import FloatArray, Pose, Travel


class SelfSensing:
    """Encoders, odometry, gyroscope and bumpers, and how they err.

    Parameters
    ----------
    robot : RobotDescription
        The robot.
    config : MotorConfig
        How they err.
    start : Pose
        Where the episode starts.
    odometry : numpy.random.Generator
        Stream of the odometry's errors.
    bumpers, gyroscope : numpy.random.SeedSequence
        Of theirs.

    Attributes
    ----------
    travel : Travel
        What the encoders tell of this control step, without drift.
    touched : int
        How many bumpers are truly touched, whatever they report.
    """

    def __init__(
        self,
        robot: RobotDescription,
        config: MotorConfig,
        start: Pose,
        odometry: np.random.Generator,
        bumpers: np.random.SeedSequence,
        gyroscope: np.random.SeedSequence,
    ) -> None:
        self._drive = robot.drive
        self._bumpers = self._gyroscope = None
        weight = 0.0
        if config.bumper_noise.active:
            rng = np.random.default_rng(bumpers)
            self._bumpers = StickyBumpers(config.bumper_noise, len(robot.bumpers), rng)
        if config.gyroscope is not None:
            rng, weight = np.random.default_rng(gyroscope), config.gyroscope.weight
            self._gyroscope = GyroscopeStream(config.gyroscope, start.heading, rng)
        self._odometry = Odometry(start, config.odometry_noise, odometry, weight)
        self.travel = Travel(0.0, 0.0, start.heading, start.heading)
        self.touched = 0

    def reckon(
        self, encoders: Sequence[float], pose: Callable[[], Pose]
    ) -> tuple[float, float, float, float]:
        """Take in what the encoders read; return the odometry as observed.

        Parameters
        ----------
        encoders : sequence of float, length E
            Their readings of this control step.
        pose : callable
            The true pose, asked for if there is a gyroscope.
        """
        travel = self._drive.travel(encoders, self.travel.heading)
        turned = None
        if self._gyroscope is not None:
            turned = self._gyroscope.turned(pose().heading)
        self._odometry.update(travel, turned)
        self.travel = travel
        return self._odometry.told()

    def tell_bumpers(self, bumpers: FloatArray) -> FloatArray:
        """Return what the bumpers report, (B,) 0 or 1, given which are touched."""
        self.touched = int(np.count_nonzero(bumpers))
        return bumpers if self._bumpers is None else self._bumpers.tell(bumpers)
