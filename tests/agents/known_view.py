"""A clock that is told the time, and a page without a browser, for the tests of the viewer."""

import http.client
import json
import time
from collections.abc import Callable
from typing import Any


class Clock:
    """A clock that goes on when it is told to."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


class Page:
    """What a browser does, by plain HTTP."""

    def __init__(self, address: str) -> None:
        self.address = address
        self.connection = http.client.HTTPConnection(address.split("/")[2], timeout=10)
        self.seen = 0

    def close(self) -> None:
        self.connection.close()

    def get(self, path: str) -> tuple[http.client.HTTPResponse, bytes]:
        self.connection.request("GET", path)
        answer = self.connection.getresponse()
        return answer, answer.read()

    def shot(self) -> tuple[dict[str, Any], bytes]:
        answer, picture = self.get(f"/shot?after={self.seen}")
        assert answer.status == 200
        number = int(answer.headers["Shot"])
        assert number != self.seen
        self.seen = number
        return json.loads(answer.headers["State"]), picture

    def post(self, path: str, said: Any, kind: str = "application/json") -> tuple[int, str]:
        self.connection.request("POST", path, json.dumps(said), {"Content-Type": kind})
        answer = self.connection.getresponse()
        return answer.status, answer.read().decode()

    def until(self, done: Callable[[dict[str, Any]], bool], *keys: str) -> dict[str, Any]:
        """Hold keys until a state is as wanted."""
        state, patience = {}, time.monotonic() + 20
        while time.monotonic() < patience:
            if keys:
                assert self.post("/hold", list(keys)) == (204, "")
            state, _ = self.shot()
            if done(state):
                return state
        raise AssertionError(f"never so: {state}")
