"""A small web server: one page, a feed of pictures, and the driver's keys."""

import json
import socket
import socketserver
import threading
from collections.abc import Generator
from contextlib import contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, cast
from urllib.parse import parse_qs, urlsplit

from nomad_agents.viewer.controls import Controls
from nomad_agents.viewer.feed import Feed
from nomad_agents.viewer.teleoperation import wish_of
from nomad_mj.errors import ConfigError, NomadError

_PAGE = Path(__file__).with_name("page.html")
_LOOPBACK = ("127.0.0.1", "::1")
_LONGEST = 1000  # [bytes] of what a page may send at once
_PATIENCE = 2.0  # [s] that a request for a picture waits
_JSON, _HTML = "application/json", "text/html; charset=utf-8"
_POLICY = (
    "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src blob: data:; connect-src 'self'"
)


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, host: str, port: int, feed: Feed, controls: Controls) -> None:
        self.feed, self.controls = feed, controls
        self.page = _PAGE.read_bytes()
        if ":" in host:
            self.address_family = socket.AF_INET6
        super().__init__((host, port), _Handler)

    def server_bind(self) -> None:
        """Bind, without asking the network for our own name."""
        socketserver.TCPServer.server_bind(self)
        host, self.server_port = self.server_address[:2]
        self.server_name = str(host)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing: a browser that goes away in the middle is no error of ours."""


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"  # one connection for all pictures
    timeout = 30.0

    @property
    def _ours(self) -> _Server:
        return cast(_Server, self.server)

    def _known_host(self) -> bool:
        """Return whether a request is for this server by a name of its own; refuse others.

        A page of another site whose name has been pointed to this machine calls it by that name.
        """
        try:
            host = urlsplit(f"//{self.headers.get('Host', '')}").hostname or ""
        except ValueError:  # a bracket that is not closed
            host = ""
        bound = str(cast("tuple[str, int]", self.server.server_address)[0])
        if bound not in _LOOPBACK or host in (*_LOOPBACK, "localhost"):
            return True
        self._refuse(HTTPStatus.FORBIDDEN, "call it localhost or 127.0.0.1", Connection="close")
        return False

    def do_GET(self) -> None:
        """Send the page, the facts or the next shot."""
        if not self._known_host():
            return
        url = urlsplit(self.path)
        if url.path == "/":
            self._send(self._ours.page, _HTML)
        elif url.path == "/facts":
            self._send(self._ours.feed.facts.encode(), _JSON)
        elif url.path == "/shot":
            after = parse_qs(url.query).get("after", ["0"])[0]
            shot = self._ours.feed.next(int(after) if after.isdecimal() else 0, _PATIENCE)
            if shot is None:
                self._send(b"", _JSON, HTTPStatus.NO_CONTENT)
            else:
                self._send(shot.picture, "image/jpeg", Shot=str(shot.number), State=shot.state)
        else:
            self._refuse(HTTPStatus.NOT_FOUND, "there are: / /facts /shot /hold /ask")

    def do_POST(self) -> None:
        """Take in keys that are held, or a request."""
        if not self._known_host():
            return
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or int(length) > _LONGEST:
            self._refuse(
                HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"at most {_LONGEST} bytes", Connection="close"
            )
            return
        body = self.rfile.read(int(length))
        # A page of another site cannot send this type without asking first.
        if self.headers.get_content_type() != _JSON:
            self._refuse(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, f"must be {_JSON}")
            return
        try:
            self._obey(json.loads(body))
        except (NomadError, ValueError) as error:
            self._refuse(HTTPStatus.BAD_REQUEST, str(error))
            return
        self._send(b"", _JSON, HTTPStatus.NO_CONTENT)

    def _obey(self, said: Any) -> None:
        """Take in a list of keys, or the name of a request; raise NomadError for anything else."""
        controls = self._ours.controls
        if self.path == "/hold" and isinstance(said, list):
            controls.hold(wish_of(str(name) for name in said))
        elif self.path == "/ask" and isinstance(said, str):
            controls.ask(said)
        else:
            raise ConfigError("send /hold a list of keys, /ask the name of a request")

    def _refuse(self, status: HTTPStatus, why: str, **headers: str) -> None:
        self._send(json.dumps({"error": why}).encode(), _JSON, status, **headers)

    def _send(
        self, body: bytes, kind: str, status: HTTPStatus = HTTPStatus.OK, **headers: str
    ) -> None:
        self.send_response(status)
        if status is not HTTPStatus.NO_CONTENT:
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Content-Security-Policy", _POLICY)
        self.send_header("X-Content-Type-Options", "nosniff")
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: Any) -> None:
        """Say nothing of each request."""


@contextmanager
def serve(host: str, port: int, feed: Feed, controls: Controls) -> Generator[str, None, None]:
    """Serve the page while the ``with`` block runs.

    Parameters
    ----------
    host, port
        Where to listen; port 0 takes a free one.
    feed, controls
        What is sent, and where what the driver asks for goes.

    Yields
    ------
    str
        The page's address.

    Raises
    ------
    ConfigError
        A host or a port where nobody can listen.
    """
    if not 0 <= port <= 65535:
        raise ConfigError(f"port {port}: must be 1 to 65535, or 0 for any that is free")
    try:
        server = _Server(host, port, feed, controls)
    except OSError as error:
        raise ConfigError(
            f"cannot listen at {host}, port {port}: {error.strerror}; "
            "--port 0 takes any port that is free"
        ) from None
    shown = f"[{host}]" if ":" in host else host
    thread = threading.Thread(target=server.serve_forever, args=(0.1,), daemon=True)
    thread.start()
    try:
        yield f"http://{shown}:{server.server_port}/"
    finally:
        feed.close()
        server.shutdown()
        thread.join()
        server.server_close()
