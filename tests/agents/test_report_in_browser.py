"""The report as a browser shows it, plays it and prints it."""

import re
from collections.abc import Generator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Browser, find_chromium
from known_report import make_section, three
from nomad_agents.experiments.report import Section, Video, write_report
from PIL import Image

import nomad_mj
from nomad_mj.video import EpisodeRecorder

CHROMIUM = find_chromium()
IMAGES = "Promise.all([...document.images].map(i => i.decode().then(() => i.naturalWidth)))"
VIDEOS = """Promise.all([...document.querySelectorAll('video')].map(
    v => new Promise((done, fail) => {
        const tell = () => done([v.readyState, v.duration]);
        v.onerror = () => fail(new Error(v.error.message));
        v.readyState >= 1 ? tell() : v.onloadedmetadata = tell;
    })
))"""


@pytest.fixture(scope="module")
def section(tmp_path_factory: pytest.TempPathFactory) -> Section:
    return make_section(tmp_path_factory.mktemp("figures"))


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory) -> Video:
    """Return a real video of the room, where OpenGL works."""
    path = tmp_path_factory.mktemp("videos") / "fig6.mp4"
    with (
        nomad_mj.load("path_finding", room="paper_room") as env,
        EpisodeRecorder(env, path, view="overview", size=(320, 240), fps=10) as recorder,
    ):
        env.reset(seed=0, start=3)
        recorder.start_episode("one move", pause=0.5)
        env.step(np.array([0.5, 0.0]))
    Image.new("RGB", (320, 240), "#1f9e77").save(path.with_suffix(".jpg"))
    return Video(path, path.with_suffix(".jpg"), "One move.")


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Generator[Browser, None, None]:
    """Return a Chromium, the same for all tests."""
    if CHROMIUM is None:
        pytest.skip("there is no Chromium here; on Debian type: sudo apt-get install -y chromium")
    with Browser(CHROMIUM, tmp_path_factory.mktemp("profile")) as started:
        yield started


def complaints(browser: Browser) -> list[dict[str, Any]]:
    """Return what a page has complained of, and what it has asked the network for."""
    asked = [
        event
        for event in browser.events
        if event["method"] == "Network.requestWillBeSent"
        and not event["params"]["request"]["url"].startswith(("data:", "file:", "about:"))
    ]
    told = ("Log.entryAdded", "Runtime.exceptionThrown", "Runtime.consoleAPICalled")
    return asked + [event for event in browser.events if event["method"] in told]


@pytest.mark.parametrize("width", [360, 768, 1200])
def test_a_browser_shows_it(width: int, section: Section, tmp_path: Path, browser: Browser) -> None:
    long = replace(section, name="a" * 80, title="b" * 120, command="c" * 300, source="d" * 99)
    write_report(tmp_path / "r.html", three(section, long), [("e" * 90, "f" * 300)], seeds=20)
    browser.events.clear()
    browser.open(tmp_path / "r.html", width, scale=2.0 if width < 500 else 1.0)
    assert min(browser.evaluate(IMAGES)) > 0
    assert browser.evaluate("document.documentElement.scrollWidth") <= width
    assert browser.evaluate("innerWidth") == width
    (tmp_path / "seen.png").write_bytes(browser.screenshot())
    with Image.open(tmp_path / "seen.png") as seen:
        assert seen.width == width * (2 if width < 500 else 1)
        assert len(seen.convert("RGB").getcolors(1 << 24) or []) > 50
    assert complaints(browser) == []


@pytest.mark.gl
def test_a_browser_plays_the_videos(
    section: Section, film: Video, tmp_path: Path, browser: Browser
) -> None:
    parts = [replace(part, video=film) for part in three(section)]
    write_report(tmp_path / "r.html", parts)
    browser.events.clear()
    browser.open(tmp_path / "r.html", 360)
    videos = browser.evaluate(VIDEOS)
    assert len(videos) == 3 and all(ready >= 1 and seconds > 0.5 for ready, seconds in videos)
    still = "[...document.querySelectorAll('.still')].every(i => i.offsetWidth === 0)"
    assert browser.evaluate(still)
    assert browser.evaluate("document.querySelector('video').play().then(() => true)")
    assert complaints(browser) == []


@pytest.mark.gl
def test_it_prints_with_stills_for_videos(
    section: Section, film: Video, tmp_path: Path, browser: Browser
) -> None:
    write_report(tmp_path / "r.html", [replace(section, video=film)])
    browser.open(tmp_path / "r.html", 1200)
    printed = browser.print_pdf()
    assert printed.startswith(b"%PDF") and len(re.findall(rb"/Type\s*/Page\b", printed)) >= 2
    browser.call("Emulation.setEmulatedMedia", media="print")
    shown = "[...document.querySelectorAll('video, .still')].map(e => e.offsetWidth > 0)"
    assert browser.evaluate(shown) == [False, True]
    browser.call("Emulation.setEmulatedMedia", media="")
