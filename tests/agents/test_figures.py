"""Figures: files of their format, free places, nothing half-written."""

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from nomad_agents.baselines import Planner
from nomad_agents.evaluation import evaluate
from nomad_agents.experiments.figures import (
    LatticeAction,
    draw_actions,
    draw_paths,
    lattice,
    lattice_actions,
)
from nomad_agents.reactive_planner import FAITHFUL
from nomad_agents.registry import make_agent

from nomad_mj.envs import PathFinding
from nomad_mj.errors import OutputError
from nomad_mj.types import FloatArray


def size_of_png(path: Path) -> tuple[int, int]:
    content = path.read_bytes()
    assert content.startswith(b"\x89PNG\r\n\x1a\n") and content.endswith(b"IEND\xaeB`\x82")
    width, height = struct.unpack(">II", content[16:24])
    return width, height


def test_paths_as_png_and_pdf(env: PathFinding, tmp_path: Path) -> None:
    agent = Planner(env.scene.robot.layout, FAITHFUL)
    trials = evaluate(env, agent, env.scene.arena.starts[:2], 0, 4)
    for name in ("fig6.png", "fig6.pdf", "fig6.svg"):
        draw_paths(env.scene, trials, tmp_path / name, "Paths")
    width, height = size_of_png(tmp_path / "fig6.png")
    assert width > 800 and height > 800
    assert (tmp_path / "fig6.pdf").read_bytes().startswith(b"%PDF-")
    assert b"</svg>" in (tmp_path / "fig6.svg").read_bytes()
    draw_paths(env.scene, [], tmp_path / "none.png", "No path")
    assert size_of_png(tmp_path / "none.png") == (width, height)
    assert len(list(tmp_path.iterdir())) == 4


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
    actions = lattice_actions(env, agent, places, 0)
    assert {(a.kind, a.unmatched) for a in actions} == {
        ("planned" if config == "plan" else "none", True)
    }
    assert all(0.009 < np.hypot(*a.move) <= 1 + 1e-9 for a in actions)
    again = lattice_actions(env, agent, places, 0)
    assert all(np.array_equal(a.move, b.move) for a, b in zip(actions, again, strict=True))
    draw_actions(env.scene, actions, tmp_path / "fig7.png", "Actions")
    assert size_of_png(tmp_path / "fig7.png")[0] > 800


def test_all_kinds_of_actions_in_one_figure(env: PathFinding, tmp_path: Path) -> None:
    kinds = [("reacted", False), ("reacted", True), ("planned", True), ("none", True)]
    actions = [
        LatticeAction(np.array([i, -2.0]), np.array([0.5, 0.5]), kind, unmatched)
        for i, (kind, unmatched) in enumerate(kinds)
    ]
    draw_actions(env.scene, actions, tmp_path / "fig7.pdf", "Actions")
    draw_actions(env.scene, [], tmp_path / "none.pdf", "Nothing")
    assert (tmp_path / "fig7.pdf").stat().st_size > (tmp_path / "none.pdf").stat().st_size > 1000


def test_a_figure_that_cannot_be_written(env: PathFinding, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"cannot write '.*fig7.png': "):
        draw_actions(env.scene, [], tmp_path / "file" / "fig7.png", "Nothing")
