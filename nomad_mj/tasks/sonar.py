"""What sonars suffer beside noise: turns, crosstalk, age and lost echoes."""

from dataclasses import dataclass
from numbers import Real

import numpy as np

from nomad_mj.errors import ConfigError
from nomad_mj.option_types import check_fields
from nomad_mj.robots import RobotDescription
from nomad_mj.tasks.crosstalk import Crosstalk, Echoes, within_reach
from nomad_mj.tasks.firing import FiringOrder, Stale, turns
from nomad_mj.tasks.readout import MISS
from nomad_mj.tasks.rings import ring_slices
from nomad_mj.types import FloatArray


@dataclass(frozen=True)
class SonarEffects:
    """Effects on rings of sonars, or of other range sensors; without options there are none.

    Attributes
    ----------
    rings : tuple of str
        Names of the rings concerned.
    firing : FiringOrder, optional
        They fire in turn; None: all in every control step.
    crosstalk : Crosstalk, optional
        Cones of a ring that fire together hear each other; None: they never do.
    limits : tuple of float
        One for each cone of a ring: nothing that is farther from it is heard [m]. Transducers age,
        and their foils get dirty: the echoes of one grow fainter than those of the next. None for
        as far as ever, and no numbers at all for every cone.
    dropout : float
        Probability with which a cone, when it fires, hears no echo at all and reads its maximum,
        as if nothing were there, in [0, 1] (the "max-range" errors of beam models: S. Thrun,
        W. Burgard and D. Fox, "Probabilistic Robotics", 2005, section 6.3).
    """

    rings: tuple[str, ...] = ("sonar",)
    firing: FiringOrder | None = None
    crosstalk: Crosstalk | None = None
    limits: tuple[float | None, ...] = ()
    dropout: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        if not 0 <= self.dropout <= 1:
            raise ConfigError(f"sonar dropout {self.dropout}: must be in [0, 1]")
        for limit in self.limits:
            if limit is not None and not (isinstance(limit, Real) and limit > 0):
                raise ConfigError(f"sonar limits: {limit} must be above 0 m, or None")
        if not self.rings:
            raise ConfigError("sonar effects: need a ring in rings")

    @property
    def active(self) -> bool:
        """Whether there is any effect."""
        return bool(self.firing or self.crosstalk or self.limits or self.dropout)


class Sonars:
    """The effects at work on a robot's readings, those of all its rings concatenated.

    Parameters
    ----------
    effects : SonarEffects
        Which ones.
    robot : RobotDescription
        The robot.

    Raises
    ------
    ConfigError
        The robot lacks a ring, or a ring has not as many cones as there are `limits`.
    """

    def __init__(self, effects: SonarEffects, robot: RobotDescription) -> None:
        layout, rays = robot.layout, robot.rays
        slices = ring_slices("sonar", effects.rings, layout)
        count = layout.count
        self._maximum = rays.maximum
        self._limits = np.full(count, np.inf)
        self._dropout = np.zeros(count)
        turn, period = np.zeros(count, dtype=np.intp), np.ones(count, dtype=np.intp)
        self._hears = np.zeros((count, count), dtype=bool)
        self._chance = effects.crosstalk.probability if effects.crosstalk else 0.0
        bearings = np.concatenate([ring.bearings for ring in layout.rings])
        for ring, part in slices:
            if effects.limits:
                self._limits[part] = _limits(effects.limits, ring.name, len(ring.bearings))
            self._dropout[part] = effects.dropout
            if effects.firing:
                turn[part], period[part] = turns(effects.firing, ring)
            if effects.crosstalk:
                together = turn[part, None] == turn[part]
                near = within_reach(bearings[part], effects.crosstalk.reach)
                self._hears[part, part] = together & near
        self._disturbed = self._hears.any(axis=1)
        self._echoes = Echoes(bearings, rays.offset, layout.radius)
        self._stale = Stale(turn, period) if effects.firing else None

    def start(self, crosstalk: np.random.Generator, dropout: np.random.Generator) -> None:
        """Begin an episode with a stream of its own for each effect that is by chance."""
        self._crosstalk_rng, self._dropout_rng = crosstalk, dropout
        if self._stale is not None:
            self._stale.start()

    def hear(self, ranges: FloatArray) -> FloatArray:
        """Return to where the pulses that come back tell an obstacle, (C,) [m].

        Parameters
        ----------
        ranges : array (C,)
            How far from the perimeter the obstacles are [m]; beyond the maximum: nothing there.
        """
        ranges = np.where(ranges > self._limits, MISS, ranges)
        if not self._chance:
            return ranges
        listens = self._crosstalk_rng.random(len(ranges)) < self._chance
        ears = np.flatnonzero(listens & self._disturbed)
        if len(ears):
            heard = self._hears[ears] & (ranges < self._maximum)
            theirs = np.where(heard, self._echoes.readings(ranges, ears), np.inf)
            ranges[ears] = np.minimum(ranges[ears], theirs.min(axis=1))
        return ranges

    def tell(self, readings: FloatArray) -> FloatArray:
        """Return what the cones report, given what they would read now, (C,) [m]."""
        if self._dropout.any():
            lost = self._dropout_rng.random(len(readings)) < self._dropout
            readings = np.where(lost, self._maximum, readings)
        return readings if self._stale is None else self._stale.hold(readings)


def _limits(limits: tuple[float | None, ...], ring: str, cones: int) -> list[float]:
    if len(limits) != cones:
        raise ConfigError(
            f"sonar limits: there are {len(limits)}, but {cones} cones in the ring {ring!r}"
        )
    return [np.inf if limit is None else limit for limit in limits]
