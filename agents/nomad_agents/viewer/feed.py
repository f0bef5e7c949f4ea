"""The newest picture and state, handed from the thread that draws to those that send."""

import threading
import time
from collections.abc import Callable
from typing import NamedTuple

_AWAY = 3.0  # [s] without any request after which nobody is watching


class Shot(NamedTuple):
    """A picture, JPEG, and the state it shows, JSON; numbered from 1 on."""

    number: int
    picture: bytes
    state: str


class Feed:
    """Holds one shot; who is too slow for all of them gets the newest.

    Parameters
    ----------
    facts : str
        What never changes, JSON.
    clock : callable
        Tells the time [s].
    """

    def __init__(self, facts: str, clock: Callable[[], float] = time.monotonic) -> None:
        self.facts = facts
        self._clock = clock
        self._changed = threading.Condition()
        self._shot = Shot(0, b"", "")
        self._asked = -_AWAY
        self._open = True

    def publish(self, picture: bytes, state: str) -> None:
        """Replace the shot by a newer one."""
        with self._changed:
            self._shot = Shot(self._shot.number + 1, picture, state)
            self._changed.notify_all()

    def next(self, after: int, patience: float) -> Shot | None:
        """Return a shot other than number `after`, waiting for it [s]; None if none comes."""
        with self._changed:
            self._asked = self._clock()
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._is_news(after) or not self._open, patience)
            self._asked = self._clock()
            return self._shot if self._is_news(after) and self._open else None

    def _is_news(self, after: int) -> bool:
        return self._shot.number not in (0, after)

    @property
    def watched(self) -> bool:
        """Whether somebody has asked for a shot of late."""
        return self._clock() - self._asked < _AWAY

    def wait_for_watcher(self, patience: float) -> bool:
        """Wait until somebody watches [s]; return whether somebody does."""
        with self._changed:
            self._changed.wait_for(lambda: self.watched, patience)
        return self.watched

    def close(self) -> None:
        """Let everybody go who waits."""
        with self._changed:
            self._open = False
            self._changed.notify_all()
