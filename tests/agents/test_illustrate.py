"""Illustrations of experiments: which figures come of which results, and of few or none."""

from collections.abc import Sequence
from pathlib import Path

import pytest
from known_experiment import Known, known_result
from nomad_agents.experiments.experiment import PLANNER, STRAIGHT, TableRow
from nomad_agents.experiments.illustrate import illustrate
from nomad_agents.experiments.paper import EXPERIMENTS
from nomad_agents.studies.runs import Result, Row
from test_figures import ACTIONS, FILM, WAYS, curve, size_of_png

TABLE = (
    TableRow("reactions", "learn_reactions", paper="1424"),
    TableRow("plannings", "learn_plannings", paper="about 300"),
)


def results_of(name: str) -> list[Result]:
    """Return results of two seeds, the second without pictures, as the experiments store them."""
    rows: Row = {
        "success_rate": 0.9,
        "strict_success_rate": 0.8,
        "learn_reactions": 700,
        "learn_solved_all": True,
    }
    ways: Row = {"ways": WAYS}
    cases: dict[str, tuple[str, Row]] = {
        "fig6": ("", ways),
        "fig7": ("", {"actions": ACTIONS}),
        "fig8": ("2 m", {"actions": ACTIONS}),
        "fig9": ("goal (2.4, 4.2)", {**ways, "actions": ACTIONS, "goal": [2.4, 4.2]}),
        "fig10": ("goal (2.4, 4.2)", {**ways, "actions": ACTIONS, "goal": [2.4, 4.2]}),
        "fig11": ("learning on", {"films": [{**FILM, "times": []}, FILM]}),
        "fig12": ("learning on", {"films": [FILM]}),
        "fig13": ("with memory", {**ways, "room": "concave_room"}),
        "fig14": ("", ways),
        "noise": ("±5 %", {}),
        "timing": ("", {"reactions": [[10, 1e-4]], "plannings": [[10, 4e-4]]}),
        "robots": ("nomad200, paper_room", ways),
        "ablations": ("as is", {}),
    }
    case, pictures = cases[name]
    made = [
        known_result(
            rows,
            name=name,
            case=case,
            seed=seed,
            pictures={} if seed else pictures,
            curve=curve(seed + 1),
        )
        for seed in range(2)
    ]
    baselines = [
        known_result({"success_rate": 0.5}, name=name, case=case, agent=agent, pictures=pictures)
        for agent in (STRAIGHT, PLANNER)
    ]
    return [*made, *baselines]


FIGURES = {
    "fig6": ["paths", "learning"],
    "fig7": ["actions", "categories"],
    "fig8": ["actions", "cases"],
    "fig9": ["actions", "paths"],
    "fig10": ["actions", "paths", "learning"],
    "fig11": ["film_learning_on"],
    "fig12": ["film_learning_on"],
    "fig13": ["paths", "learning"],
    "fig14": ["paths", "learning"],
    "noise": ["cases"],
    "timing": ["times"],
    "robots": ["paths"],
    "ablations": ["variants"],
}


def drawn(name: str, results: Sequence[Result], folder: Path) -> list[str]:
    illustrations = illustrate(Known(name, TABLE), results, folder)
    for path, caption in illustrations:
        assert caption.endswith(".") and "\n" not in caption
        assert (folder / f"{path.name}.pdf").stat().st_size > 2000
        assert (folder / f"{path.name}.png").stat().st_size > 2000
    assert len(list(folder.iterdir() if folder.exists() else [])) == 2 * len(illustrations)
    return [path.name.removeprefix(f"{name}_") for path, _ in illustrations]


@pytest.mark.parametrize("name", FIGURES)
def test_the_figures_of_each_experiment(tmp_path: Path, name: str) -> None:
    assert drawn(name, results_of(name), tmp_path) == FIGURES[name]


def test_every_experiment_is_illustrated() -> None:
    assert set(EXPERIMENTS) <= set(FIGURES)


@pytest.mark.parametrize("name", FIGURES)
def test_results_that_hold_nothing_are_not_drawn(tmp_path: Path, name: str) -> None:
    assert drawn(name, [], tmp_path) == []
    assert drawn(name, [known_result(name=name), known_result(name="other")], tmp_path) == []


def test_after_adapting_beside_before(tmp_path: Path) -> None:
    results = [*results_of("fig9"), *results_of("fig10")]
    path = illustrate(Known("fig10"), results, tmp_path)[0].path
    width, height = size_of_png(tmp_path / f"{path.name}.png")
    assert path.name == "fig10_actions" and width > 1.5 * height


def test_an_experiment_without_figures(tmp_path: Path) -> None:
    assert drawn("another", [known_result(name="another")], tmp_path) == []
