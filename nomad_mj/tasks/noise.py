"""How real sensors err: range readings and odometry."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from nomad_mj.errors import ConfigError
from nomad_mj.option_types import check_fields
from nomad_mj.types import FloatArray, IntArray

RangeNoiseKind = Literal["uniform", "gaussian", "none"]
_BLOCK = 64  # control steps whose noise is drawn at once
_LEAST = 1e-3  # factor: so that what hits nothing still reads the maximum


@dataclass(frozen=True)
class RangeNoise:
    """How range readings err: d' = d (1 + e) (section 2.1 of the paper), and echoes that are lost.

    To the wavelength of a sonar, some 7 mm, a wall is a mirror: a pulse that strikes it at a
    grazing angle goes off and never comes back, and the sensor reads its maximum range (R. Kuc and
    M. W. Siegel, "Physically based simulation model for acoustic sensor robot navigation", IEEE
    Trans. PAMI 9 (1987); J. J. Leonard and H. F. Durrant-Whyte, "Directed sonar sensing for mobile
    robot navigation", 1992). Each ray of a cone is judged by itself, and the cone reads the
    shortest that comes back. What edges scatter, and two walls of a corner throw back, is left out.

    Attributes
    ----------
    kind : "uniform", "gaussian" or "none"
        Distribution of e.
    level : float
        e is in [-level, level] if uniform, of standard deviation `level` if Gaussian.
    grazing : float, optional
        Largest angle of incidence, from the surface's normal [rad], from which an echo comes back,
        in (0, pi/2]; None: from every one. A mirror sends back only what strikes it square on, for
        which half the angle between two rays of a cone is right; rough walls take larger ones.
    specular_rings : tuple of str
        Names of the rings that `grazing` concerns.
    """

    kind: RangeNoiseKind = "uniform"
    level: float = 0.15
    grazing: float | None = None
    specular_rings: tuple[str, ...] = ("sonar",)

    def __post_init__(self) -> None:
        check_fields(self)
        if self.kind not in ("uniform", "gaussian", "none"):
            raise ConfigError(f"range noise {self.kind!r}: must be uniform, gaussian or none")
        if not 0 <= self.level < 1:
            raise ConfigError(f"range noise level {self.level}: must be in [0, 1)")
        if self.grazing is None:
            return
        if not 0 < self.grazing <= math.pi / 2:
            raise ConfigError(f"range noise grazing {self.grazing}: must be in (0, pi/2] rad")
        if not self.specular_rings:
            raise ConfigError("range noise grazing: needs a ring in specular_rings")


@dataclass(frozen=True)
class OdometryNoise:
    """Errors of the odometry, all zero by default, as in the paper.

    Attributes
    ----------
    distance, heading : float
        Standard deviations of the distance [m] and of the heading [rad] after 1 m; they grow with
        the square root of the distance.
    position : float
        Each coordinate reported is wrong by U[-position, position] [m], anew at each reading
        (Fig 8 of the paper).
    heading_per_metre : float
        The heading that is reported turns by so much with each metre forward, and back again on
        the way back [rad/m]: what unequal wheels do, the worst of the systematic errors (J.
        Borenstein and L. Feng, "Measurement and correction of systematic odometry errors in mobile
        robots", IEEE Trans. Robotics and Automation 12 (1996)).
    heading_per_second : float
        And by so much with each second [rad/s], even where the robot stands: a turret that creeps
        (section 7.1 of the paper). A `Gyroscope` corrects both.
    """

    distance: float = 0.0
    heading: float = 0.0
    position: float = 0.0
    heading_per_metre: float = 0.0
    heading_per_second: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        for name in ("distance", "heading", "position"):
            if not 0 <= getattr(self, name) < math.inf:
                raise ConfigError(f"odometry noise {name} {getattr(self, name)}: must be >= 0")
        for name in ("heading_per_metre", "heading_per_second"):
            if not math.isfinite(getattr(self, name)):
                raise ConfigError(f"odometry noise {name} {getattr(self, name)}: must be finite")


class RangeNoiseStream:
    """Draws the factors (1 + e) for a round of readings at a time.

    Attributes
    ----------
    block : array (64, sensors)
        Factors of so many control steps.
    next : int
        Which of them is next; -1 if all are 1 for ever.
    """

    def __init__(self, noise: RangeNoise, sensors: int, rng: np.random.Generator) -> None:
        self._noise = noise
        self._shape = (_BLOCK, sensors)
        self._rng = rng
        self.block: FloatArray = np.ones((1, sensors))
        self.next = _BLOCK if noise.kind != "none" and noise.level > 0 else -1

    def factors(self) -> FloatArray:
        """Return the next factors, one a sensor, always above 0."""
        if self.next < 0:
            return self.block[0]
        if self.next == _BLOCK:  # one call of the generator serves many control steps
            self.draw()
        row = self.block[self.next]
        self.next += 1
        return row

    def draw(self) -> None:
        """Draw the factors of the control steps to come."""
        level = self._noise.level
        if self._noise.kind == "uniform":
            self.block = self._rng.uniform(1 - level, 1 + level, self._shape)
        else:
            self.block = np.maximum(self._rng.normal(1.0, level, self._shape), _LEAST)
        self.next = 0


class RangeNoiseStreams:
    """The streams of N robots under the same noise, asked all at once.

    Parameters
    ----------
    streams : int
        How many.
    sensors : int
        Of each robot.
    """

    def __init__(self, streams: int, sensors: int) -> None:
        self._streams: list[RangeNoiseStream | None] = [None] * streams
        self._blocks: FloatArray = np.ones((streams, _BLOCK, sensors))
        self._next = np.full(streams, -1, dtype=np.intp)

    def go_on(self, number: int, stream: RangeNoiseStream) -> None:
        """Let a robot's factors go on from where a stream is; it is not to be asked any more."""
        self._streams[number] = stream
        self._next[number] = stream.next
        if stream.next >= 0:
            self._blocks[number] = stream.block

    def factors(self, numbers: IntArray) -> FloatArray:
        """Return the next factors of robots (n,), (n, sensors)."""
        rows = self._next[numbers]
        if len(rows) and rows[0] < 0:
            return self._blocks[numbers, 0]
        for number in numbers[rows == _BLOCK].tolist():
            stream = self._streams[number]
            assert stream is not None
            stream.draw()
            self.go_on(number, stream)
        rows = self._next[numbers]
        self._next[numbers] = rows + 1
        return self._blocks[numbers, rows]
