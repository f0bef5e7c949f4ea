"""View a session in a browser: simulate and draw here, show and steer there."""

import json
import time
from collections.abc import Callable
from contextlib import suppress

from nomad_agents.viewer.controls import LOOKING
from nomad_agents.viewer.feed import Feed
from nomad_agents.viewer.pace import Pace
from nomad_agents.viewer.pictures import Pictures
from nomad_agents.viewer.report import Reporter, facts
from nomad_agents.viewer.server import serve
from nomad_agents.viewer.session import ClosedError, Session
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.video.layout import Size

_RAREST = 0.25  # [s] between two pictures on a slow machine
_NAP = 0.5  # [s]


class _Broadcast:
    """Publishes a session step by step, in real time where the machine draws fast enough."""

    def __init__(
        self, session: Session, pictures: Pictures, feed: Feed, going: Callable[[], bool]
    ) -> None:
        self._session, self._pictures, self._feed = session, pictures, feed
        self._going = going
        self._reporter = Reporter(session)
        self._pace = Pace(CONTROL_TIMESTEP)
        self._drawn = 0.0

    def __call__(self) -> None:
        self._pictures.follow()
        for request in self._session.controls.take(LOOKING):
            if request == "camera":
                self._pictures.next_camera()
            else:
                self._pictures.grid = not self._pictures.grid
        now = time.monotonic()
        # Who is late drops a picture rather than slow down the simulation.
        if self._pace.late < CONTROL_TIMESTEP or now - self._drawn > _RAREST:
            self._drawn = now
            state = self._reporter.state() | {"camera": self._pictures.camera}
            self._feed.publish(self._pictures.jpeg(), json.dumps(state))
        self._pace.wait()
        while self._going():
            if self._feed.wait_for_watcher(_NAP):
                return
        raise ClosedError


def view_in_browser(
    session: Session,
    *,
    host: str = "127.0.0.1",
    port: int = 0,
    size: Size = (720, 540),
    ready: Callable[[str], None] = lambda address: None,
    going: Callable[[], bool] = lambda: True,
) -> None:
    """Serve a session to browsers until it is to end; it rests while nobody watches.

    Parameters
    ----------
    session : Session
        What to show and drive.
    host, port
        Where to listen; port 0 takes a free one.
    size : (int, int)
        Width and height of the pictures [px], even.
    ready : callable
        Called with the page's address once it is there.
    going : callable
        Asked again and again whether to go on.

    Raises
    ------
    ConfigError
        A host, a port or a size that there cannot be.
    RenderError
        No OpenGL works here.
    """
    feed = Feed(json.dumps(facts(session)))
    with (
        serve(host, port, feed, session.controls) as address,
        Pictures(session, size) as pictures,
    ):
        broadcast = _Broadcast(session, pictures, feed, going)
        ready(address)
        with suppress(ClosedError), session.shown_by(broadcast):
            broadcast()
            while True:
                session.advance()
