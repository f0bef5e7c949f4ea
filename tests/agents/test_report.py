"""The report: one page that holds everything, is well formed, and that a browser shows."""

import re
from collections.abc import Generator
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from browser import Browser, find_chromium
from matplotlib.figure import Figure
from nomad_agents.experiments.experiment import Study, Verdict
from nomad_agents.experiments.report import NoVideo, Section, Video, provenance, write_report
from nomad_agents.experiments.runs import Result, Run
from PIL import Image

import nomad_mj
from nomad_mj.errors import OutputError
from nomad_mj.video import EpisodeRecorder

ODD = """<script>alert("1 & 'x'")</script> é 大 {{ 7 * 7 }} """
CHROMIUM = find_chromium()
VOID = {"meta", "link", "img", "br", "rect", "path", "circle"}
IMAGES = "Promise.all([...document.images].map(i => i.decode().then(() => i.naturalWidth)))"
VIDEOS = """Promise.all([...document.querySelectorAll('video')].map(
    v => new Promise((done, fail) => {
        const tell = () => done([v.readyState, v.duration]);
        v.onerror = () => fail(new Error(v.error.message));
        v.readyState >= 1 ? tell() : v.onloadedmetadata = tell;
    })
))"""


class Table(NamedTuple):
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


class Picture(NamedTuple):
    path: Path
    caption: str


class Page(HTMLParser):
    """A page taken apart: elements with their attributes, and the text of headings."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str]]] = []
        self.open: list[str] = []
        self.words: dict[str, list[str]] = {}
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, {name: value or "" for name, value in attrs}))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, {name: value or "" for name, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and data.strip():
            self.words.setdefault(self.open[-1], []).append(data)

    def all(self, tag: str) -> list[dict[str, str]]:
        return [attributes for name, attributes in self.elements if name == tag]


@pytest.fixture(scope="module")
def section(tmp_path_factory: pytest.TempPathFactory) -> Section:
    """Return a section with a table, a figure as PNG and PDF, and no video."""
    folder = tmp_path_factory.mktemp("figures")
    figure = Figure((4, 3))
    figure.add_subplot().plot([0, 1, 0])
    for suffix in ("png", "pdf"):
        figure.savefig(folder / f"a.{suffix}", dpi=160)
    table = Table(
        ("", "paper", "ours: median [quartiles]", "ours: IQM (95 %)", "planner at every decision"),
        (
            ("seeds that solve all starts", "1 of 1", "20 of 20", "", ""),
            ("reactions while learning", "1424", "760 [723, 786]", "", "1000.0 [1000.0, 1000.0]"),
        ),
    )
    pictures = [Picture(folder / "a.png", "A line."), Picture(folder / "a.pdf", "It again.")]
    return Section(
        "fig6",
        "Learning",
        "It learns.",
        "Section 4",
        Verdict("holds", "All do."),
        table,
        pictures,
        NoVideo("no OpenGL works here"),
        "nomad-mj reproduce fig6 --seeds 20",
    )


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


def parse(path: Path) -> Page:
    return Page(path.read_text(encoding="utf-8"))


def three(section: Section, *others: Section) -> list[Section]:
    part = replace(section, name="fig9", verdict=Verdict("holds in part", "Some do."))
    return [
        section,
        part,
        replace(part, name="fig13", verdict=Verdict("does not hold", "none does")),
        *others,
    ]


def test_the_page_is_whole_and_for_everybody(section: Section, tmp_path: Path) -> None:
    path = tmp_path / "new" / "report.html"
    write_report(path, three(section), [("Seeds", "0 to 19")], seeds=20)
    page = parse(path)
    assert not page.open and page.all("html") == [{"lang": "en"}]
    assert len(page.all("img")) == 6 and all(image["alt"] for image in page.all("img"))
    ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(ids) == len(set(ids))
    pointed = [link["href"] for link in page.all("a")]
    assert pointed == ["#fig6", "#fig9", "#fig13"] and {link[1:] for link in pointed} <= set(ids)
    labels = [a["aria-labelledby"] for _, a in page.elements if "aria-labelledby" in a]
    assert {name for label in labels for name in label.split()} <= set(ids)
    levels = [int(tag[1]) for tag, _ in page.elements if re.fullmatch(r"h[1-6]", tag)]
    assert levels[0] == 1 and levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))
    assert list(tmp_path.rglob(".*")) == []


def test_the_page_needs_nothing_but_itself(section: Section, tmp_path: Path) -> None:
    write_report(tmp_path / "r.html", three(section))
    page = parse(tmp_path / "r.html")
    pointing = ("src", "href", "poster", "srcset", "data", "action", "xlink:href")
    targets = [a[name] for _, a in page.elements for name in pointing if name in a]
    assert targets and all(target.startswith(("data:", "#")) for target in targets)
    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert (
        "@import" not in text and "url(" not in text and "//" not in re.sub(r"base64,\S*", "", text)
    )
    assert not page.all("script")
    policy = next(meta for meta in page.all("meta") if "http-equiv" in meta)
    assert policy["content"].startswith("default-src 'none'")


def test_the_same_sections_give_the_same_bits(section: Section, tmp_path: Path) -> None:
    for name in ("a.html", "b.html"):
        write_report(tmp_path / name, three(section), [("Python", "3.11")], seeds=2)
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()


def test_verdicts_claims_tables_and_commands_are_told(section: Section, tmp_path: Path) -> None:
    write_report(tmp_path / "r.html", three(section), [("Seeds", "0 to 19")])
    page = parse(tmp_path / "r.html")
    chips = [
        a["class"].split("-")[1] for a in page.all("span") if a.get("class", "")[:5] == "chip "
    ]
    assert sorted(chips) == sorted(["holds", "part", "fails"] * 3)
    assert {"All do.", "Some do.", "None does."} <= set(page.words["span"])
    heads = [word for word in page.words["th"] if word in section.table.headings]
    # A column in which nobody says anything is left out.
    assert "ours: median [quartiles]" in heads and "ours: IQM (95 %)" not in heads
    assert page.words["td"].count("760 [723, 786]") == 3
    assert page.words["code"] == [section.command] * 3 and page.words["dd"][-1] == "0 to 19"
    assert sum("no OpenGL works here" in word for word in page.words["p"]) == 3
    assert page.words["p"].count("It learns.") == 3 and page.words["cite"].count("Section 4") == 3


def test_names_are_text_whatever_they_are(section: Section, tmp_path: Path) -> None:
    odd = Section(
        ODD,
        ODD,
        ODD,
        ODD,
        Verdict("holds", ODD),
        Table(("", ODD), ((ODD, ODD),)),
        [Picture(section.illustrations[0].path, ODD)],
        NoVideo(ODD),
        ODD,
    )
    write_report(tmp_path / "r.html", [odd, odd, replace(odd, name="大")], [(ODD, ODD)])
    page = parse(tmp_path / "r.html")
    assert not page.all("script") and page.words["code"] == [ODD] * 3
    assert page.all("img")[0]["alt"].startswith(ODD)
    ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
    assert len(ids) == len(set(ids)) and all(re.fullmatch(r"[\w-]+", each) for each in ids)


def test_no_experiment_gives_a_page_too(tmp_path: Path) -> None:
    write_report(tmp_path / "r.html", [])
    assert "No experiment was run." in parse(tmp_path / "r.html").words["p"]


def test_what_cannot_be_shown_is_told_in_one_line(section: Section, tmp_path: Path) -> None:
    (tmp_path / "broken.png").write_bytes(b"no picture")
    for name in ("missing.png", "broken.png", "notes.txt"):
        part = replace(section, illustrations=[Picture(tmp_path / name, "")])
        with pytest.raises(OutputError, match=name) as raised:
            write_report(tmp_path / "r.html", [part])
        assert "\n" not in str(raised.value)
    assert not (tmp_path / "r.html").exists()


def test_provenance_is_that_of_all_machines() -> None:
    study = Study("faithful", "paper_room", "nomad200", 2)
    machines = (
        {"python": "3.12.1", "system": "B", "wall_s": 1800},
        {"system": "A", "wall_s": 1800},
    )
    results = [
        Result(Run("fig6", "", agent, "faithful", "paper_room", "nomad200", 0), {}, machine=machine)
        for agent, machine in zip(("reactive_planner", "straight"), machines, strict=True)
    ]
    facts = dict(provenance(study, results))
    assert facts == dict(provenance(study, results[::-1]))
    assert facts["Machine"] == "A; B" and facts["Seeds"] == "0 to 1" and facts["Python"] == "3.12.1"
    assert facts["Runs"] == "1 of the learner, 1 of the baselines; 1.0 hours of computing"
    assert f"nomad-mj {nomad_mj.__version__}" in facts["Versions"]


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
