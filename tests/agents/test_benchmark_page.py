"""The benchmark's figures and page, drawn from made-up results."""

from pathlib import Path

import numpy as np
import pytest
from browser import Browser, find_chromium
from known_benchmark import made_up
from nomad_agents.benchmark.figures.efficiency import spread_out
from nomad_agents.benchmark.figures.looks import look, spoken
from nomad_agents.benchmark.presentation import present
from nomad_agents.learners import LEARNERS
from PIL import Image

AGENTS = ("straight", "planner", "sac:ranges", "reactive_planner:tuned")
IMAGES = "Promise.all([...document.images].map(i => i.decode().then(() => i.naturalWidth)))"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the page of a benchmark of two sets; figures and tables lie beside it."""
    folder = tmp_path_factory.mktemp("benchmark")
    results = made_up(("convex", "wide"), AGENTS, seeds=2)
    present(results, "nomad-mj benchmark --seeds 2", folder / "benchmark", folder / "page.html")
    return folder / "page.html"


def test_figures_are_drawn_as_png_and_pdf(page: Path) -> None:
    figures = page.parent / "benchmark" / "figures"
    names = {"intervals_spl", "intervals_success_rate", "profiles_spl"}
    names |= {"efficiency_convex", "efficiency_wide"}
    assert {path.stem for path in figures.iterdir()} == names
    for name in names:
        assert (figures / f"{name}.pdf").read_bytes().startswith(b"%PDF")
        with Image.open(figures / f"{name}.png") as drawn:
            colours = drawn.convert("RGB").getcolors(1 << 24) or []
            assert drawn.width > 600 and len(colours) > 50


def test_the_page_says_what_the_tables_say(page: Path) -> None:
    text = page.read_text()
    for word in ("convex", "wide", "nomad-mj benchmark --seeds 2", "sac:ranges"):
        assert word in text
    assert text.count("<img") == 5
    assert "http" not in text.replace("http-equiv", "").replace("http://www.w3.org", "")


def test_a_browser_shows_it(page: Path, tmp_path: Path) -> None:
    chromium = find_chromium()
    if chromium is None:
        pytest.skip("there is no Chromium here; on Debian type: sudo apt-get install -y chromium")
    with Browser(chromium, tmp_path / "profile") as browser:
        for width in (360, 1200):
            browser.events.clear()
            browser.open(page, width)
            assert min(browser.evaluate(IMAGES)) > 0
            assert browser.evaluate("document.documentElement.scrollWidth") <= width
            told = ("Log.entryAdded", "Runtime.exceptionThrown")
            assert not [event for event in browser.events if event["method"] in told]


def test_agents_can_be_told_apart() -> None:
    labels = [f"{name}:{variant}" for name, each in LEARNERS.items() for variant in each.variants]
    looks = {label: look(label)[:2] for label in labels if LEARNERS[label.split(":")[0]].learns}
    assert len(set(looks.values())) == len(looks)
    assert len({look(name)[:2] for name in LEARNERS}) == len(LEARNERS)
    assert spoken("reactive_planner:tuned") == "reactive planner, tuned"
    assert look("mine") == look("mine")  # an agent that nobody knows has a look as well


@pytest.mark.parametrize("levels", [[1.0] * 6, [0.0, 0.01, 0.5, 0.99, 1.0, 1.0], [0.3]])
def test_names_beside_the_figure_keep_apart(levels: list[float]) -> None:
    places = spread_out(levels)
    assert (np.diff(places) >= 4.2 - 1e-9).all() and max(places) <= 103
