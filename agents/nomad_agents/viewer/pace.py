"""Keep a simulation to real time, or slower where the machine is."""

import time
from collections.abc import Callable

_LATEST = 0.25  # [s] behind, at which it gives up catching up


class Pace:
    """A metronome.

    Parameters
    ----------
    timestep : float
        Between two beats [s].
    clock, sleep : callable
        Tells the time [s]; waits for so long [s].
    """

    def __init__(
        self,
        timestep: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self._timestep, self._clock, self._sleep = timestep, clock, sleep
        self._next = clock()

    @property
    def late(self) -> float:
        """How long ago the next beat should have been [s]; negative before it."""
        return self._clock() - self._next

    def wait(self) -> None:
        """Wait for the next beat; after a long delay begin anew from now."""
        self._next += self._timestep
        if self.late > _LATEST:
            self._next = self._clock()
        elif self.late < 0:
            self._sleep(-self.late)
