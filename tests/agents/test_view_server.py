"""The page of the viewer: by plain HTTP, and in a browser."""

import contextlib
import json
import queue
import threading
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest
from browser import Browser, find_chromium
from known_view import Clock, Page
from nomad_agents.viewer import Session, view_in_browser
from nomad_agents.viewer.controls import Controls
from nomad_agents.viewer.feed import Feed

import nomad_mj

ONCE = """new Promise(done => {
    const there = () => document.readyState === 'complete' && typeof $ === 'function';
    const look = () => { if (there() && (SO)) done(true); else setTimeout(look, 50); };
    look();
})"""


@pytest.fixture(scope="module")
def page() -> Generator[Page, None, None]:
    """Return a page that is served, of a Nomad 200 in the clutter."""
    ready: queue.Queue[str | Exception] = queue.Queue()
    going = threading.Event()
    going.set()

    def work() -> None:
        try:
            with nomad_mj.load("path_finding", "clutter") as env:
                session = Session(env, Controls(), start=0)
                view_in_browser(session, size=(320, 240), ready=ready.put, going=going.is_set)
        except Exception as error:
            ready.put(error)

    thread = threading.Thread(target=work)
    thread.start()
    address = ready.get(timeout=30)
    assert isinstance(address, str), address
    with contextlib.closing(Page(address)) as opened:
        yield opened
    going.clear()
    thread.join(10)
    assert not thread.is_alive() and ready.empty()


@pytest.mark.gl
def test_the_page_needs_nothing_from_elsewhere(page: Page) -> None:
    answer, body = page.get("/")
    assert answer.status == 200 and answer.headers["Content-Type"].startswith("text/html")
    assert "default-src 'none'" in answer.headers["Content-Security-Policy"]
    text = body.decode().replace("http://www.w3.org/2000/svg", "")
    assert "://" not in text and "@import" not in text and " src=" not in text
    facts = json.loads(page.get("/facts")[1])
    assert facts["robot"] == "nomad200" and facts["room"] == "clutter"
    assert [ring["name"] for ring in facts["rings"]] == ["sonar", "infrared"]


@pytest.mark.gl
def test_w_drives_forward_and_silence_stops(page: Page) -> None:
    page.post("/ask", "reset")
    begin = page.until(lambda state: state["time"] < 0.5)
    driven = page.until(lambda state: state["x"] > begin["x"] + 0.25, "forward")
    assert driven["y"] == pytest.approx(begin["y"], abs=0.02) and driven["speed"] > 0.2
    state, picture = page.shot()
    assert picture.startswith(b"\xff\xd8\xff") and len(picture) > 3000
    assert len(state["ranges"]["sonar"]) == 16 and state["driver"] == "hand"
    end = page.until(lambda state: abs(state["speed"]) < 0.005)
    assert end["x"] > driven["x"] and end["time"] - driven["time"] < 3


@pytest.mark.gl
def test_cameras_and_the_grid_change_the_picture_only(page: Page) -> None:
    before, _ = page.shot()
    cameras: list[str] = []
    for _ in range(3):
        page.post("/ask", "camera")
        last = cameras[-1] if cameras else before["camera"]
        cameras.append(page.until(lambda state, last=last: state["camera"] != last)["camera"])
    assert cameras == ["overview", "top", "chase"]
    assert page.shot()[0]["x"] == pytest.approx(before["x"], abs=0.01)


@pytest.mark.gl
@pytest.mark.parametrize(
    ("path", "said", "kind", "told"),
    [
        ("/hold", ["up"], "application/json", (400, "unknown key 'up'; there are: aside_left, ")),
        ("/hold", "forward", "application/json", (400, "send /hold a list of keys")),
        ("/ask", "fly", "application/json", (400, "unknown request 'fly'; there are: agent, ")),
        ("/ask", "reset", "text/plain", (415, "must be application/json")),
        ("/ask", "x" * 2000, "application/json", (413, "at most 1000 bytes")),
    ],
)
def test_what_makes_no_sense_is_refused(
    page: Page, path: str, said: Any, kind: str, told: tuple[int, str]
) -> None:
    status, answer = page.post(path, said, kind)
    assert status == told[0] and told[1] in json.loads(answer)["error"]


@pytest.mark.gl
@pytest.mark.parametrize(
    ("host", "status"),
    [
        ("localhost", 200),
        ("127.0.0.1:9", 200),
        ("[::1]:9", 200),
        ("evil.example", 403),
        ("[", 403),
        ("", 403),
    ],
)
def test_it_answers_to_names_of_this_machine_alone(page: Page, host: str, status: int) -> None:
    page.connection.request("GET", "/facts", headers={"Host": host})
    answer = page.connection.getresponse()
    answer.read()
    assert answer.status == status


@pytest.mark.gl
def test_there_is_nothing_else(page: Page) -> None:
    assert page.get("/etc/passwd")[0].status == 404
    page.connection.request("POST", "/hold", "{", {"Content-Type": "application/json"})
    answer = page.connection.getresponse()
    assert answer.status == 400 and answer.read()


@pytest.mark.gl
def test_a_browser_shows_it_and_its_keys_drive(page: Page, tmp_path: Path) -> None:
    chromium = find_chromium()
    if chromium is None:
        pytest.skip("there is no Chromium here; on Debian type: sudo apt-get install -y chromium")
    page.post("/ask", "reset")
    with Browser(chromium, tmp_path) as browser:
        for width in (1280, 375):
            size = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": width < 500}
            browser.call("Emulation.setDeviceMetricsOverride", **size)
            browser.call("Page.navigate", url=page.address)
            assert browser.evaluate(ONCE.replace("SO", "$('picture').naturalWidth === 320"))
            assert browser.evaluate("document.documentElement.scrollWidth") <= width
        browser.call("Input.dispatchKeyEvent", type="keyDown", code="KeyW", key="w")
        assert browser.evaluate(ONCE.replace("SO", "parseFloat($('speed').textContent) > 0.2"))
        assert browser.evaluate("document.querySelectorAll('button.down').length") == 1
        browser.call("Input.dispatchKeyEvent", type="keyUp", code="KeyW", key="w")
        assert browser.evaluate(ONCE.replace("SO", "parseFloat($('speed').textContent) < 0.05"))
        told = ("Log.entryAdded", "Runtime.exceptionThrown", "Runtime.consoleAPICalled")
        assert [event for event in browser.events if event["method"] in told] == []


def test_who_is_slow_gets_the_newest_and_who_waits_is_let_go() -> None:
    clock = Clock()
    feed = Feed("{}", clock)
    assert not feed.watched and feed.next(0, 0.0) is None and feed.watched
    for i in range(3):
        feed.publish(bytes([i]), str(i))
    shot = feed.next(1, 0.0)
    assert shot is not None and (shot.number, shot.picture, shot.state) == (3, b"\x02", "2")
    assert feed.next(3, 0.0) is None
    clock.now += 60
    assert not feed.wait_for_watcher(0.0)
    waiting = threading.Thread(target=feed.next, args=(3, 60.0))
    waiting.start()
    feed.close()
    waiting.join(5)
    assert not waiting.is_alive()
