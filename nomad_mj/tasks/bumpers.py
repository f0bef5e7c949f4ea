"""Bumpers that stick: contacts that stay closed after the touch."""

from dataclasses import dataclass

import numpy as np

from nomad_mj.errors import ConfigError
from nomad_mj.option_types import check_fields
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.types import FloatArray


@dataclass(frozen=True)
class BumperNoise:
    """How bumpers err; without options they do not.

    A bumper is a strip that closes a switch. Rubber takes time to come back, drivers hold a touch
    on purpose so that no poll misses it, and a strip can be caught (on tactile bumpers: H. R.
    Everett, "Sensors for Mobile Robots", 1995, chapter 3).

    Attributes
    ----------
    hold : float
        A bumper reads 1 for so long after it was touched last [s].
    sticking : float
        Probability with which one that is let go of stays pressed until it is touched again, in
        [0, 1].
    """

    hold: float = 0.0
    sticking: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        if not 0 <= self.hold < np.inf:
            raise ConfigError(f"bumper noise hold {self.hold}: must be 0 s or more")
        if not 0 <= self.sticking <= 1:
            raise ConfigError(f"bumper noise sticking {self.sticking}: must be in [0, 1]")

    @property
    def active(self) -> bool:
        """Whether the bumpers err at all."""
        return self.hold > 0 or self.sticking > 0


class StickyBumpers:
    """The bumpers of an episode.

    Parameters
    ----------
    noise : BumperNoise
        How they err.
    count : int
        How many there are.
    rng : numpy.random.Generator
        Stream of the errors.
    """

    def __init__(self, noise: BumperNoise, count: int, rng: np.random.Generator) -> None:
        self._sticking, self._rng = noise.sticking, rng
        self._steps = round(noise.hold / CONTROL_TIMESTEP)
        self._left = np.zeros(count, dtype=np.intp)
        self._touched = np.zeros(count, dtype=bool)
        self._stuck = np.zeros(count, dtype=bool)

    def tell(self, bumpers: FloatArray) -> FloatArray:
        """Return what the bumpers report, (B,) 0 or 1, given which are touched."""
        touched = bumpers > 0
        let_go = self._touched & ~touched
        caught = self._rng.random(len(touched)) < self._sticking
        self._stuck = (self._stuck & ~touched) | (let_go & caught)
        told = touched | (self._left > 0) | self._stuck
        self._left = np.where(touched, self._steps, np.maximum(self._left - 1, 0))
        self._touched = touched
        return told.astype(np.float64)
