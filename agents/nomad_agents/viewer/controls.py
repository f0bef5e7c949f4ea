"""What the driver asks for, handed from the thread that hears of it to the one that simulates."""

import threading
import time
from collections.abc import Callable

from nomad_agents.viewer.teleoperation import PATIENCE, Wish
from nomad_mj.errors import UnknownNameError

DRIVING = ("stop", "reset", "agent")
"""Requests that change what the robot does."""
LOOKING = ("camera", "grid")
"""Requests that change what is seen."""


class Controls:
    """A mailbox between threads.

    Parameters
    ----------
    clock : callable
        Tells the time [s].
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = threading.Lock()
        self._asked: list[str] = []
        self._wish, self._heard = Wish(), -PATIENCE

    def hold(self, wish: Wish) -> None:
        """Take in which way the driver wants to go now."""
        with self._lock:
            self._wish, self._heard = wish, self._clock()

    def ask(self, request: str) -> None:
        """Take in a request; raise UnknownNameError if it is not one of those above."""
        if request not in DRIVING + LOOKING:
            raise UnknownNameError("request", request, DRIVING + LOOKING)
        with self._lock:
            self._asked.append(request)

    def take(self, kinds: tuple[str, ...]) -> list[str]:
        """Return the requests of these kinds, in order; they are then done with."""
        with self._lock:
            taken = [request for request in self._asked if request in kinds]
            self._asked = [request for request in self._asked if request not in kinds]
            return taken

    @property
    def wish(self) -> tuple[Wish, float]:
        """The newest wish and when it came [s]."""
        with self._lock:
            return self._wish, self._heard

    @property
    def urgent(self) -> bool:
        """Whether the driver wants to take over from an agent, or anything else of the robot."""
        with self._lock:
            fresh = self._clock() - self._heard < PATIENCE
            return (fresh and self._wish != Wish()) or any(r in DRIVING for r in self._asked)
