"""A gyroscope: it measures turning itself, and knows nothing of wheels that slip."""

import math
from dataclasses import dataclass

import numpy as np

from nomad_mj.errors import ConfigError
from nomad_mj.option_types import check_fields
from nomad_mj.scene import CONTROL_TIMESTEP

_DEGREE = math.pi / 180


@dataclass(frozen=True)
class Gyroscope:
    """A rate gyroscope on the robot, whose integral corrects the heading of the encoders.

    The paper proposes one against mechanical errors of the robot's orientation (section 7.1). Its
    own errors are the two that matter over minutes, in the terms of IEEE Std 952-1997: white noise
    of the rate, which makes the angle a random walk, and a bias that wanders about zero, here with
    an exponential correlation. What bias it has when it is switched on is taken off before the
    start, where the robot stands still. The defaults are those of a sensor of the kind that robots
    carry (Analog Devices ADIS16405: 0.05 deg/s/sqrt(Hz), 0.007 deg/s).

    Of each turn the robot believes `weight` parts as the gyroscope measures it, and the rest as
    the encoders do: a complementary filter of the two rates. (J. Borenstein and L. Feng,
    "Gyrodometry", IEEE Int. Conf. Robotics and Automation 1996, switch over to the gyroscope
    where the two differ much; a slow drift of the encoders would never be noticed so.)

    Attributes
    ----------
    angle_random_walk : float
        Standard deviation of the angle after 1 s [rad/sqrt(s)]; it grows with the square root of
        the time.
    bias_instability : float
        Standard deviation of the bias [rad/s].
    correlation_time : float
        In which the bias forgets what it was [s].
    weight : float
        Of the gyroscope against the encoders, in [0, 1].
    """

    angle_random_walk: float = 0.05 * _DEGREE
    bias_instability: float = 0.007 * _DEGREE
    correlation_time: float = 100.0
    weight: float = 0.98

    def __post_init__(self) -> None:
        check_fields(self)
        for name in ("angle_random_walk", "bias_instability"):
            if not 0 <= getattr(self, name) < math.inf:
                raise ConfigError(f"gyroscope {name} {getattr(self, name)}: must be >= 0")
        if not self.correlation_time > 0:
            raise ConfigError(
                f"gyroscope correlation_time {self.correlation_time}: must be above 0 s"
            )
        if not 0 <= self.weight <= 1:
            raise ConfigError(f"gyroscope weight {self.weight}: must be in [0, 1]")


class GyroscopeStream:
    """A gyroscope at work in an episode.

    Parameters
    ----------
    gyroscope : Gyroscope
        How it errs.
    heading : float
        Of the robot at the start [rad].
    rng : numpy.random.Generator
        Stream of its errors.
    """

    def __init__(self, gyroscope: Gyroscope, heading: float, rng: np.random.Generator) -> None:
        self._rng = rng
        self._heading = heading
        step = CONTROL_TIMESTEP
        self._noise = gyroscope.angle_random_walk * math.sqrt(step)
        self._keep = math.exp(-step / gyroscope.correlation_time)
        self._wander = gyroscope.bias_instability * math.sqrt(1.0 - self._keep**2)
        self._bias = gyroscope.bias_instability * float(rng.normal())

    def turned(self, heading: float) -> float:
        """Return the turn since the last call, a control step ago, as measured [rad].

        Parameters
        ----------
        heading : float
            Where the robot truly points now [rad].
        """
        white, wander = self._rng.normal(size=2).tolist()
        turn = math.remainder(heading - self._heading, 2 * math.pi)
        self._heading = heading
        measured = turn + self._bias * CONTROL_TIMESTEP + self._noise * white
        self._bias = self._keep * self._bias + self._wander * wander
        return measured
