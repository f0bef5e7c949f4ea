"""Grids: every combination once, by the names of the command line; mistakes before anything."""

import itertools
from dataclasses import fields
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from nomad_agents.cli.main import main
from nomad_agents.cli.task_options import TaskOptions
from nomad_agents.reactive_planner import TUNED
from nomad_agents.sweeps.grid import as_data, from_data, read_grid, show
from nomad_agents.sweeps.options import Option, catalogue, find_option, read_value
from nomad_agents.sweeps.settings import settle

NUMBERS = st.lists(st.floats(0.01, 0.99), min_size=1, max_size=4, unique=True)
GRIDS = st.dictionaries(
    st.sampled_from(["k_ind", "planner.margin", "range_noise", "situation.width"]), NUMBERS
)


@given(axes=GRIDS, seeds=st.integers(1, 3))
def test_a_grid_is_every_combination_with_every_seed_once(
    axes: dict[str, list[float]], seeds: int
) -> None:
    words = [f"{name}={','.join(map(str, values))}" for name, values in axes.items()]
    grid = read_grid(words, "", "7", seeds)
    runs = grid.runs()
    wanted = list(itertools.product(range(seeds), *axes.values()))
    assert [(run.seed, *(value for name, value in run.cell if name in axes)) for run in runs] == (
        wanted
    )
    assert len(set(runs)) == len(runs) == len(grid)
    assert from_data(as_data(grid)) == grid
    probed = {pair for cell in grid.probes() for pair in cell}
    assert probed == {(name, value) for name, values in grid.axes for value in values}
    assert all(dict(run.cell)["starts"] == "7" for run in runs)


@given(data=st.data(), known=st.sampled_from(list(catalogue().values())))
def test_what_a_value_is_shown_as_reads_back(data: st.DataObject, known: Option) -> None:
    kinds = {bool: st.booleans(), int: st.integers(), float: st.floats(-1e9, 1e9)}
    if known.kind in kinds:
        value = data.draw(kinds[known.kind])
        assert read_value(known, show(value)) == read_value(known, value) == value
    assert read_value(known, known.usual) == known.usual
    assert settle({known.name: known.usual}, 3) == settle({}, 3)


def test_options_of_the_command_line_and_nested_parameters_are_known() -> None:
    assert {each.name for each in fields(TaskOptions)} <= set(catalogue())
    assert find_option("--range-noise").name == "range_noise"
    values = {"config": "tuned", "situation.grid.resolution": 0.1, "train.max_decisions": 9}
    settings = settle(values, 4)
    assert settings.config.planner == TUNED.planner
    assert settings.config.situation.grid.resolution == 0.1
    assert (settings.training.seed, settings.training.max_decisions) == (4, 9)


def test_a_file_says_the_same_as_words(tmp_path: Path) -> None:
    path = tmp_path / "grid.yaml"
    path.write_text('goal: ["8,6", "3,4"]\nk_ind: [0.1, 2e-2]\ngyroscope: true\n')
    words = ['goal="8,6","3,4"', "k_ind=0.1,0.02", "gyroscope=true"]
    assert read_grid([], str(path), "5", 2) == read_grid(words, "", "5", 2)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("k_indd=1", "unknown option 'k_indd'; did you mean k_ind"),
        ("zzz=1", "unknown option 'zzz'; there are: room, robot, goal"),
        ("max_decisions=5", "did you mean evaluate.max_decisions or train.max_decisions?"),
        ("k_ind", "'k_ind' is no option=value,value; options are: room, "),
        ("k_ind=0.1,lots", "k_ind 'lots': must be a number"),
        ("k_ind=nan", "k_ind 'nan': must be a number"),
        ("max_passes=1.5", "max_passes '1.5': must be a whole number"),
        ("gyroscope=yes", "gyroscope 'yes': must be true or false"),
        ("no_match=guess", "no_match 'guess': must be plan or nearest or stay"),
        ("k_ind=0.1,0.10", "k_ind has 0.1 twice"),
        ("k_ind=", "k_ind has no value"),
        ("k_ind=0.1 k-ind=0.2", "k_ind is given twice"),
        ("room=atlantis", "unknown room 'atlantis'; there are: "),
        ("goal=8,6", "goal '8': must be X,Y"),
        ("agent=sleeper", "unknown agent 'sleeper'; there are: "),
        ("grazing=0", "grazing 0: must be above 0"),
        ("min_passes=0", "min_passes 0: must be 1 or more"),
        ("agent=straight --seeds 0", "seeds 0: must be 1 or more"),
        ("agent=straight --jobs 0", "jobs 0: must be 1 or more"),
        ("agent=straight --starts none.csv", "starts file 'none.csv' cannot be read"),
        ("agent=straight --grid none.yaml", "grid file 'none.yaml' cannot be read"),
        ("agent=straight --address auto --backend processes", "--address is of a Ray cluster"),
        ("agent=straight --backend threads", "--backend"),
        ("agent=a.npz k_ind=0.1", "checkpoint 'a.npz' has its own parameters"),
        ("--only-read", "holds no results of a sweep"),
    ],
)
def test_mistakes_are_told_in_one_line_before_anything_is_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: str, told: str
) -> None:
    assert main(["sweep", *words.split(), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1
    assert not list(tmp_path.glob("out/*.journal"))
