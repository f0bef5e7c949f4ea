"""How real sensors err: range readings and odometry."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from nomad_mj.errors import ConfigError
from nomad_mj.types import FloatArray

RangeNoiseKind = Literal["uniform", "gaussian", "none"]
_BLOCK = 64  # control steps whose noise is drawn at once


@dataclass(frozen=True)
class RangeNoise:
    """Multiplicative noise of the range readings, d' = d (1 + e) (section 2.1 of the paper).

    Attributes
    ----------
    kind : "uniform", "gaussian" or "none"
        Distribution of e.
    level : float
        e is in [-level, level] if uniform, of standard deviation `level` if Gaussian.
    """

    kind: RangeNoiseKind = "uniform"
    level: float = 0.15

    def __post_init__(self) -> None:
        if self.kind not in ("uniform", "gaussian", "none"):
            raise ConfigError(f"range noise {self.kind!r}: must be uniform, gaussian or none")
        if not 0 <= self.level < 1:
            raise ConfigError(f"range noise level {self.level}: must be in [0, 1)")


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
    """

    distance: float = 0.0
    heading: float = 0.0
    position: float = 0.0

    def __post_init__(self) -> None:
        for name in ("distance", "heading", "position"):
            if not getattr(self, name) >= 0:
                raise ConfigError(f"odometry noise {name} {getattr(self, name)}: must be >= 0")


class RangeNoiseStream:
    """Draws the factors (1 + e) for a round of readings at a time."""

    def __init__(self, noise: RangeNoise, sensors: int, rng: np.random.Generator) -> None:
        self._noise = noise
        self._shape = (_BLOCK, sensors)
        self._rng = rng
        self._block: FloatArray = np.ones((1, sensors))
        self._next = _BLOCK if noise.kind != "none" and noise.level > 0 else -1

    def factors(self) -> FloatArray:
        """Return the next factors, one a sensor, never negative."""
        if self._next < 0:
            return self._block[0]
        if self._next == _BLOCK:  # one call of the generator serves many control steps
            level = self._noise.level
            if self._noise.kind == "uniform":
                self._block = self._rng.uniform(1 - level, 1 + level, self._shape)
            else:
                self._block = np.maximum(self._rng.normal(1.0, level, self._shape), 0.0)
            self._next = 0
        row = self._block[self._next]
        self._next += 1
        return row
