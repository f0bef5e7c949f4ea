"""Sonars that fire in turn: between their turns they tell what they last heard."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from nomad_mj.errors import ConfigError
from nomad_mj.option_types import check_fields
from nomad_mj.types import FloatArray, IntArray, RangeRing

Order = Literal["sequential", "spread"]


@dataclass(frozen=True)
class FiringOrder:
    """In which order the cones of a ring fire.

    A pulse of the Polaroid 6500 is 38 ms on its way to an obstacle at 6.5 m and back, and the
    Nomad fires its sonars one after another, in an order and at a rate that can be set (``conf_sn``
    of the maker's ``Nclient.h``). So most of the ring's readings are old ones. Sonars that fire
    together, or nearly so, had better be far apart: see `Crosstalk`.

    Attributes
    ----------
    per_step : int
        So many cones fire in a control step of 50 ms; the others keep their last readings.
    order : "sequential" or "spread"
        Neighbours fire together, then the next ones along the ring; or cones as far apart as can
        be, then their neighbours.
    """

    per_step: int = 4
    order: Order = "sequential"

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.per_step >= 1:
            raise ConfigError(f"firing order per_step {self.per_step}: must be 1, 2, 3, ...")
        if self.order not in ("sequential", "spread"):
            raise ConfigError(f"firing order {self.order!r}: must be sequential or spread")


def turns(order: FiringOrder, ring: RangeRing) -> tuple[IntArray, int]:
    """Return when each cone fires, (C,), and in how many control steps all have fired once."""
    count = len(ring.bearings)
    period = -(-count // order.per_step)
    # Rounded: the last bit must not make the first cone the last one.
    bearings = np.mod(np.round(ring.bearings, 9), 2 * np.pi)
    around = np.argsort(np.argsort(bearings, kind="stable"))
    if order.order == "sequential":
        return around // order.per_step, period
    return around % period, period


class Stale:
    """Keeps the readings of cones whose turn it is not.

    The sonars have been at work before an episode begins: its first readings are all fresh.

    Parameters
    ----------
    turn : array (C,)
        When each cone fires.
    period : array (C,)
        After how many control steps it fires again.
    """

    def __init__(self, turn: IntArray, period: IntArray) -> None:
        self._turn, self._period = turn, period
        self.start()

    def start(self) -> None:
        """Forget what was heard in the episode before."""
        self._held: FloatArray | None = None
        self._step = 0

    def hold(self, readings: FloatArray) -> FloatArray:
        """Return `readings` (C,) where a cone has just fired, else its last one [m]."""
        if self._held is None:
            self._held = readings.copy()
            return readings
        fires = self._step % self._period == self._turn
        self._step += 1
        self._held = np.where(fires, readings, self._held)
        return self._held.copy()
