"""Grids: every combination once, by the names of the command line; mistakes before anything."""

import itertools
import math
from dataclasses import fields
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from nomad_agents.baselines import VfhConfig
from nomad_agents.cli.main import main
from nomad_agents.deep import SacSettings
from nomad_agents.reactive_planner import TUNED
from nomad_agents.sweeps.grid import Grid, as_data, from_data, meant, read_grid, show
from nomad_agents.sweeps.options import Option, catalogue, find_option, read_value
from nomad_agents.sweeps.settings import settle
from nomad_agents.task_options import TaskOptions

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


OWN = {
    "k_ind": (0.1, 0.2, 0.3),
    "planner.margin": (0.1, 0.2),
    "vfh.safety": (0.1, 0.2),
    "sac.tau": (0.01, 0.02),
    "observation": ("situation", "ranges"),
    "range_noise": (0.0, 0.1),
}
AGENT_NAMES = ("reactive_planner", "planner", "vfh", "straight", "sac", "a.npz")


@given(
    agents=st.lists(st.sampled_from(AGENT_NAMES), min_size=1, unique=True),
    names=st.lists(st.sampled_from([*OWN, "agent"]), unique=True),
)
def test_what_an_agent_does_not_have_makes_no_combinations_for_it(
    agents: list[str], names: list[str]
) -> None:
    values = {**OWN, "agent": tuple(agents)}
    grid = Grid(tuple((name, values[name]) for name in dict.fromkeys([*names, "agent"])), 2)
    cells = grid.cells()
    assert len(set(cells)) == len(cells) == len(grid) / 2
    assert [meant(cell) for cell in cells] == cells
    for agent in agents:
        own = [dict(cell) for cell in cells if dict(cell)["agent"] == agent]
        has = [name for name in names if name != "agent" and find_option(name).is_of(agent)]
        assert {tuple(cell[name] for name in has) for cell in own} == set(
            itertools.product(*(OWN[name] for name in has))
        )
        assert len(own) == math.prod(len(OWN[name]) for name in has)
        others = [name for name in names if name != "agent" and name not in has]
        assert all(cell[name] is None for cell in own for name in others)
    assert cells == sorted(
        cells,
        key=lambda cell: [
            values[name].index(value) if value is not None else 0 for name, value in cell
        ],
    )
    probed = {pair for cell in grid.probes() for pair in cell}
    assert probed == {pair for cell in cells for pair in cell}


def test_each_option_is_told_to_its_agent_alone() -> None:
    values = {"vfh.safety": 0.3, "sac.hidden": "8,4", "decisions": 7, "k_ind": 0.7}
    assert settle({**values, "agent": "vfh"}, 1).own == VfhConfig(safety=0.3)
    deep = settle({**values, "agent": "sac", "observation": "ranges", "vfh.safety": None}, 1)
    assert deep.own == SacSettings(hidden=(8, 4))
    assert (deep.variant(), deep.budget, deep.learner().deep) == ("ranges", 7, True)
    assert settle(values, 1).own is None and settle(values, 1).config.k_ind == 0.7
    assert read_value(find_option("sac.hidden"), [64, 32]) == "64,32"
    assert read_value(find_option("sac.hidden"), 64) == "64"


@given(data=st.data(), known=st.sampled_from(list(catalogue().values())))
def test_what_a_value_is_shown_as_reads_back(data: st.DataObject, known: Option) -> None:
    whole = st.integers(1 - 2**63, 2**63 - 1)
    kinds = {bool: st.booleans(), int: whole, float: st.floats(-1e9, 1e9)}
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
        ("agent=a.npz k_ind=0.1", "k_ind is an option of reactive_planner, not of a.npz; choose"),
        (
            "agent=straight,sac config=tuned",
            "config is an option of reactive_planner, planner, vfh",
        ),
        ("vfh.safety=0.1", "vfh.safety is an option of vfh, not of reactive_planner"),
        ("agent=vfh,dwa vfh.safety=-1", "agent=vfh, vfh.safety=-1.0, starts=50: safety -1.0: must"),
        ("agent=sac sac.hidden=big", "sac.hidden 'big': must be whole numbers such as 64,64"),
        ("agent=sac sac.tau=2", "tau 2.0: must be from 0 to 1"),
        ("agent=ppo ppo.hidden=0", "hidden 0: layers must have 1 unit or more"),
        ("agent=td3 decisions=0", "decisions 0: must be 1 or more"),
        ("agent=ppo observation=smell", "observation 'smell': must be situation or ranges"),
        ("--only-read", "holds no results of a sweep"),
        ("--only-read k_ind=0.1", "--only-read shows all there is in --out; beside that it takes"),
        ("--only-read --seeds 2", "--only-read shows all there is in --out; beside that it takes"),
        ("--only-read --starts 9", "--only-read shows all there is in --out; beside that it takes"),
        ("--only-read --jobs 7", "--only-read shows all there is in --out; beside that it takes"),
    ],
)
def test_mistakes_are_told_in_one_line_before_anything_is_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: str, told: str
) -> None:
    assert main(["sweep", *words.split(), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1
    assert {path.suffix for path in tmp_path.glob("out/sweep.*")} <= {".lock"}
