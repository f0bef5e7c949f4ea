"""Exported runs and episodes: read back to the same bits, in an order of their own."""

import csv
import math
import random
import struct
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from known_experiment import known_result
from nomad_agents.experiments.experiment import PLANNER
from nomad_agents.studies.export import export
from nomad_agents.studies.runs import Result

from nomad_mj.errors import OutputError


def read(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def some_results() -> list[Result]:
    results = [
        known_result({"n": 0.1 * seed, "late": None}, name=name, case="2 m, wrong", seed=seed)
        for name in ("fig9", "fig6")
        for seed in (1, 0)
    ]
    results.append(known_result({"only": True, "seed": 7}, agent=PLANNER))
    for result in results:
        result.machine = {"system": "Linux, of some kind", "wall_s": 1.5}
        result.episodes = [{"x": 1 / 3, "reached": True}, {"x": -0.0, "reached": False}]
    return results


def test_a_row_a_run_and_a_row_an_episode(tmp_path: Path) -> None:
    results = some_results()
    runs, episodes = (read(path) for path in export(results, tmp_path / "new"))
    assert [(r["experiment"], r["case"], r["seed"]) for r in runs] == [
        ("fig6", "", "0"),
        ("fig6", "2 m, wrong", "0"),
        ("fig6", "2 m, wrong", "1"),
        ("fig9", "2 m, wrong", "0"),
        ("fig9", "2 m, wrong", "1"),
    ]
    known = {"nomad-mj", "mujoco", "numpy", "system", "wall_s", "only", "row_seed", "n", "late"}
    assert known < set(runs[0])
    assert (runs[0]["only"], runs[0]["row_seed"], runs[0]["n"]) == ("True", "7", "")
    assert runs[0]["mujoco"] and runs[0]["system"] == "Linux, of some kind"
    assert len(episodes) == 10
    assert [e["episode"] for e in episodes] == ["0", "1"] * 5
    assert float(episodes[0]["x"]) == 1 / 3 and episodes[1]["x"] == "-0.0"


def test_the_order_of_the_results_does_not_show(tmp_path: Path) -> None:
    results = some_results()
    first = [path.read_bytes() for path in export(results, tmp_path)]
    random.Random(0).shuffle(results)
    assert [path.read_bytes() for path in export(results, tmp_path)] == first
    assert {path.name for path in tmp_path.iterdir()} == {"runs.csv", "episodes.csv"}


@settings(max_examples=50)
@given(st.lists(st.floats(), max_size=5), st.text("a,\"\n' é", max_size=5))
def test_numbers_and_names_read_back(
    tmp_path_factory: pytest.TempPathFactory, values: list[float], case: str
) -> None:
    row = {f"v{number}": value for number, value in enumerate(values)}
    path, _ = export([known_result(row, case=case)], tmp_path_factory.getbasetemp() / "bits")
    (back,) = read(path)
    assert back["case"] == case
    for name, value in row.items():
        if math.isnan(value):  # there is no such number
            assert back[name] == ""
        else:
            assert struct.pack("d", float(back[name])) == struct.pack("d", value)


def test_nothing_to_export(tmp_path: Path) -> None:
    runs, episodes = export([], tmp_path)
    assert runs.read_text().startswith("experiment,case,agent,config,room,robot,seed,nomad-mj,")
    assert episodes.read_text() == "experiment,case,agent,config,room,robot,seed,episode\n"


def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"cannot write '.*runs.csv': "):
        export([], tmp_path / "file")
