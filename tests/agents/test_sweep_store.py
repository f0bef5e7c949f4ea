"""The results of a sweep: nothing twice, nothing lost, wherever it was cut off."""

import json
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nomad_agents.sweeps import store as store_module
from nomad_agents.sweeps.grid import Grid, SweepRun
from nomad_agents.sweeps.store import TABLE, Store, as_table, locked, open_store, read_store
from nomad_agents.sweeps.summary import make_summary

from nomad_mj.errors import ConfigError, OutputError

GRID = Grid((("k_ind", (0.1, 0.2)), ("room", ("a", "b", "c"))), 2)
SOURCES = {"packages": {"mujoco": "3"}, "files": {"a.xml": "digest"}}


def row(run: SweepRun) -> dict[str, object]:
    """Return made-up numbers; only some runs have learnt."""
    cell = dict(run.cell)
    k_ind = cell["k_ind"]
    assert isinstance(k_ind, float)
    made: dict[str, object] = {"spl": k_ind / 3 + run.seed, "none": float("nan")}
    if cell["room"] == "b":
        made["learn_reactions"] = 7 * run.seed
    return made | {"machine_wall_s": 0.5}


def filled(folder: Path, count: int, *, fold: bool) -> Store:
    store = open_store(folder, GRID, SOURCES)
    store.fold()
    for run in store.missing()[:count]:
        store.add(run, row(run))
    if fold:
        store.fold()
    return store


WHOLE = as_table(GRID, {run: row(run) for run in GRID.runs()})


def test_the_table_shows_each_combinations_own_numbers(tmp_path: Path) -> None:
    table = make_summary(filled(tmp_path, len(GRID), fold=False), ["spl", "learn_reactions"])
    assert [row[:3] for row in table.rows] == [(k, r, "2") for k in ("0.1", "0.2") for r in "abc"]
    assert [row[3] for row in table.rows[::3]] == ["0.533 [0.283, 0.783]", "0.567 [0.317, 0.817]"]
    assert [bool(row[5]) for row in table.rows] == [False, True, False] * 2


@settings(max_examples=25)
@given(cut=st.integers(0, 1200), folded=st.integers(0, 6))
def test_cut_off_at_any_byte_it_goes_on_to_the_same_table(
    tmp_path_factory: pytest.TempPathFactory, cut: int, folded: int
) -> None:
    folder = tmp_path_factory.mktemp("cut")
    filled(folder, folded, fold=True)
    filled(folder, 5, fold=False)
    journal = folder / "sweep.journal"
    content = journal.read_bytes()
    journal.write_bytes(content[:cut])
    whole = content[:cut].count(b"\n")
    store = open_store(folder, GRID, SOURCES)
    assert len(store.rows) == folded + whole
    assert len(store.missing()) == len(GRID) - folded - whole
    filled(folder, len(GRID), fold=True)
    assert pq.read_table(folder / TABLE).equals(WHOLE) or str(
        pq.read_table(folder / TABLE).to_pylist()
    ) == str(WHOLE.to_pylist())


def test_killed_between_table_and_journal_nothing_counts_twice(tmp_path: Path) -> None:
    filled(tmp_path, 4, fold=False)
    journal = tmp_path / "sweep.journal"
    lines = journal.read_bytes()
    open_store(tmp_path, GRID, SOURCES).fold()  # takes them into the table
    assert not journal.exists()
    journal.write_bytes(lines)
    (tmp_path / f".{TABLE}.half").write_bytes(b"PAR1")
    store = open_store(tmp_path, GRID, SOURCES)
    store.fold()
    assert len(store.rows) == 4 == pq.read_table(tmp_path / TABLE).num_rows
    assert sorted(path.name for path in tmp_path.iterdir()) == [TABLE]


def test_many_results_go_into_the_table_by_and_by(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store_module, "_OFTEN", 3)
    filled(tmp_path, 7, fold=False)
    assert pq.read_table(tmp_path / TABLE).num_rows == 6
    held = read_store(tmp_path)
    assert held is not None and len(held.rows) == 7


def test_seeds_and_values_may_be_added(tmp_path: Path) -> None:
    filled(tmp_path, len(GRID), fold=True)
    more = Grid((("room", ("a", "b", "c", "d")), ("k_ind", (0.2, 0.1))), 3)
    store = open_store(tmp_path, more, SOURCES)
    assert len(store.rows) == len(GRID) and len(store.grid) == 24
    assert len(store.missing()) == 24 - len(GRID)
    store.fold()
    assert len(open_store(tmp_path, Grid(more.axes, 1), SOURCES).grid) == 24


def test_a_sweep_that_has_no_results_yet_gives_way_to_any(tmp_path: Path) -> None:
    open_store(tmp_path, Grid((("grazing", (0.0,)),), 1), SOURCES).fold()
    assert open_store(tmp_path, GRID, SOURCES).grid == GRID


def test_a_journal_whose_table_is_gone_is_not_thrown_away(tmp_path: Path) -> None:
    filled(tmp_path, 4, fold=False)
    (tmp_path / TABLE).rename(tmp_path / "moved.parquet")
    for _ in range(2):
        with pytest.raises(OutputError, match=r"sweep.journal' holds results .* put that back"):
            open_store(tmp_path, GRID, SOURCES)
    (tmp_path / "moved.parquet").rename(tmp_path / TABLE)
    assert len(open_store(tmp_path, GRID, SOURCES).rows) == 4


@pytest.mark.parametrize(
    ("grid", "sources", "told"),
    [
        (Grid((("k_ind", (0.1, 0.2)),), 2), SOURCES, "holds a sweep of other options: k_ind, room"),
        (Grid((("k_ind", (0.1,)), GRID.axes[1]), 2), SOURCES, "with k_ind=0.2 too"),
        (GRID, {**SOURCES, "packages": {"mujoco": "4"}}, "another mujoco"),
        (GRID, {**SOURCES, "files": {"a.xml": "edited"}}, "another a.xml"),
    ],
)
def test_another_sweep_is_refused(
    tmp_path: Path, grid: Grid, sources: dict[str, dict[str, str]], told: str
) -> None:
    filled(tmp_path, 2, fold=True)
    with pytest.raises(ConfigError, match=told):
        open_store(tmp_path, grid, sources)
    held = read_store(tmp_path)
    assert held is not None and len(held.rows) == 2


def test_one_sweep_at_a_time(tmp_path: Path) -> None:
    with (
        locked(tmp_path),
        pytest.raises(OutputError, match="is in use by another sweep, process"),
        locked(tmp_path),
    ):
        raise AssertionError
    (tmp_path / "sweep.lock").write_text("123456 of a machine that has gone")
    with locked(tmp_path):
        pass


def cut_table(folder: Path) -> None:
    (folder / TABLE).write_bytes((folder / TABLE).read_bytes()[:50])


def spoil_journal(folder: Path) -> None:
    (folder / "sweep.journal").write_text("{}\n" + json.dumps({"cell": []}) + "\n")


@pytest.mark.parametrize("spoil", [cut_table, spoil_journal])
def test_what_is_damaged_is_named(tmp_path: Path, spoil: Callable[[Path], None]) -> None:
    filled(tmp_path, 2, fold=True)
    spoil(tmp_path)
    with pytest.raises(OutputError, match=r"sweep\.(parquet|journal)") as told:
        read_store(tmp_path)
    assert "\n" not in str(told.value)
