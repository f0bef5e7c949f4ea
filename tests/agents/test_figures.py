"""Figures: files of their format, of the same bytes again, whole or not at all."""

import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
import pytest
import shapely
from nomad_agents.experiments.figures import Panel, draw_actions, draw_paths
from nomad_agents.experiments.figures.cases import Shares, draw_cases
from nomad_agents.experiments.figures.categories import draw_categories
from nomad_agents.experiments.figures.film_strip import draw_film
from nomad_agents.experiments.figures.learning_curve import draw_learning
from nomad_agents.experiments.figures.timing import draw_timing
from nomad_agents.experiments.figures.variants import Measure, draw_variants
from nomad_agents.experiments.lattice import lattice
from nomad_agents.experiments.pictures import Action, Film, Way, action_map
from nomad_agents.reactive_planner import FAITHFUL
from nomad_agents.registry import make_agent
from nomad_agents.studies.runs import Row
from nomad_agents.studies.statistics import spread

from nomad_mj.envs import PathFinding
from nomad_mj.errors import OutputError
from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray

Draw = Callable[[Scene, Path], None]
WAYS: list[Way] = [
    {"track": [[-3, -3], [0, -1], [0, 3]], "reached": True},
    {"track": [[2, -1], [2.5, 0.5]], "reached": False},
    {"track": [[-2.5, 1]], "reached": False},
]
KINDS = [("reacted", False), ("reacted", True), ("planned", True), ("none", True)]
ACTIONS: list[Action] = [
    {
        "place": [0.5 * column - 2, 0.5 * row - 3],
        "move": [0.3 * row, 0.3 - 0.2 * column],
        "kind": KINDS[(row + column) % 4][0],
        "unmatched": KINDS[(row + column) % 4][1],
        "category": (row // 2 * 3 + column // 3) % 5 - 1,
    }
    for row in range(6)
    for column in range(7)
]
TIMES = np.arange(0, 12.3, 0.25)
FILM: Film = {
    "times": TIMES.tolist(),
    "robot": np.stack([TIMES / 4 - 2, 0 * TIMES - 2, 0 * TIMES], axis=1).tolist(),
    "goal": np.stack([0 * TIMES, 3 - TIMES / 9], axis=1).tolist(),
    "obstacles": [[[2 - t / 5, -3.0], [3.0, -2.0]] for t in TIMES.tolist()],
    "radius": 0.3,
    "reached": True,
}


def curve(passes: int, starts: int = 50) -> list[Row]:
    return [
        {
            "pass": n,
            "reactions": 90 * n + passes,
            "plannings": 20 * n,
            "virtual_collisions": n,
            "solved": starts * n // passes,
            "starts": starts,
        }
        for n in range(1, passes + 1)
    ]


SOME = np.array([0.9, 0.8, 1.0, 0.95])
DRAWN: dict[str, Draw] = {
    "paths": lambda scene, path: draw_paths([Panel("Ways", scene, WAYS)], path),
    "no-paths": lambda scene, path: draw_paths([Panel("None", scene, [])], path),
    "actions": lambda scene, path: draw_actions([Panel("Actions", scene, ACTIONS)] * 2, path),
    "no-actions": lambda scene, path: draw_actions([Panel("None", scene, [])] * 5, path),
    "categories": lambda scene, path: draw_categories(Panel("Categories", scene, ACTIONS), path),
    "one-category": lambda scene, path: draw_categories(Panel("One", scene, ACTIONS[-1:]), path),
    "film": lambda scene, path: draw_film(scene, FILM, path, "Moving"),
    "short-film": lambda scene, path: draw_film(
        scene, {**FILM, "times": [0.25], "obstacles": [[]]}, path, "Short"
    ),
    "learning": lambda _, path: draw_learning(
        {"one": [curve(3), curve(1), curve(90), []], "two": [curve(2, 1)]},
        path,
        "Learning",
        {"solved": (500, 100)},
    ),
    "cases": lambda _, path: draw_cases(
        [
            Shares("reached", {"ours": {"1 m": spread([SOME]), "2 m": spread([SOME[:1]])}}),
            Shares("clear", {"straight": {"2 m": spread([SOME])}, "planner": {}}),
        ],
        path,
        "Cases",
        joined=True,
    ),
    "timing": lambda _, path: draw_timing([(10, 1e-4), (10, 2e-4), (99, 3e-4)], [], path, "Times"),
    "variants": lambda _, path: draw_variants(
        [
            Measure("reactions", {"as is": SOME, "never": np.full(3, np.nan)}),
            Measure("strict", {"as is": SOME, "one run": SOME[:1]}),
        ],
        path,
        "Variants",
    ),
}


def size_of_png(path: Path) -> tuple[int, int]:
    content = path.read_bytes()
    assert content.startswith(b"\x89PNG\r\n\x1a\n") and content.endswith(b"IEND\xaeB`\x82")
    width, height = struct.unpack(">II", content[16:24])
    return width, height


@pytest.mark.parametrize("name", DRAWN)
def test_pdf_and_png_and_the_same_bytes_again(
    env: PathFinding, tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    pdf, png = tmp_path / "a 0.5 m.pdf", tmp_path / "a 0.5 m.png"
    DRAWN[name](env.scene, tmp_path / "a 0.5 m")
    assert {*tmp_path.iterdir()} == {pdf, png}
    assert min(size_of_png(png)) > 300
    first = pdf.read_bytes(), png.read_bytes()
    assert first[0].startswith(b"%PDF-") and b"/Subtype /Image" not in first[0]
    before = dict(matplotlib.rcParams)
    monkeypatch.setitem(matplotlib.rcParams, "lines.linewidth", 9)  # a user's own style
    DRAWN[name](env.scene, tmp_path / "a 0.5 m")
    assert (pdf.read_bytes(), png.read_bytes()) == first
    assert dict(matplotlib.rcParams) == {**before, "lines.linewidth": 9}


def test_what_is_drawn_shows(env: PathFinding, tmp_path: Path) -> None:
    contents = set[bytes]()
    lost: list[Way] = [{**WAYS[0], "reached": False}]
    for ways in ([], WAYS[:1], WAYS[1:2], lost):
        draw_paths([Panel("Ways", env.scene, ways)], tmp_path / "ways")
        contents.add((tmp_path / "ways.png").read_bytes())
    assert len(contents) == 4


@pytest.mark.parametrize("spacing", [0.5, 0.7, 2.0])
def test_places_of_the_lattice_are_free_and_regular(env: PathFinding, spacing: float) -> None:
    scene = env.scene
    places = lattice(scene, spacing)
    assert (scene.plan.clearance(places, scene.robot.layout.radius) > 0.05).all()
    assert shapely.contains_xy(scene.free_space, places).all()
    for axis in places.T:
        steps: FloatArray = np.diff(np.unique(np.round(axis / spacing, 9)))
        assert steps == pytest.approx(np.rint(steps)) and steps.min() > 0.5
    assert len(places) > 0.5 * 80 / spacing**2 - 20 / spacing


@pytest.mark.parametrize("config", ["plan", "stay"])
def test_actions_at_a_lattice(env: PathFinding, tmp_path: Path, config: str) -> None:
    agent = make_agent(
        "reactive_planner",
        env.scene.robot.layout,
        replace(FAITHFUL, no_match=config),  # type: ignore[arg-type]
    )
    places = lattice(env.scene, 2.0)
    actions = action_map(env, agent, places, 0)
    assert {(a["kind"], a["unmatched"], a["category"]) for a in actions} == {
        ("planned" if config == "plan" else "none", True, -1)
    }
    lengths: FloatArray = np.hypot(*np.array([a["move"] for a in actions]).T)
    assert (lengths > 0.009).all() and (lengths <= 1 + 1e-4).all()
    assert actions == action_map(env, agent, places, 0)
    draw_actions([Panel("Actions", env.scene, actions)], tmp_path / "fig7")
    assert size_of_png(tmp_path / "fig7.png")[0] > 800


def test_a_figure_that_cannot_be_written(env: PathFinding, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"cannot write '.*fig7.pdf': "):
        draw_actions([Panel("None", env.scene, [])], tmp_path / "file" / "fig7")
