"""``nomad-mj benchmark`` as its users call it, in a room that is learnt in seconds."""

import csv
import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from nomad_agents.cli.main import main

Call = Callable[..., int]
AGENTS = ("straight", "reactive_planner:tuned")
SMALL = ("--seeds", "2", "--starts", "2", "--check-starts", "1", "--budget", "10")


@pytest.fixture
def call(small_room: Path) -> Call:
    """Return a caller of the command in the small room."""

    def run(*words: str, out: Path, room: Path = small_room) -> int:
        told = ["benchmark", "--agents", *AGENTS, "--rooms", str(room), *SMALL, "--curves"]
        return main([*told, "--jobs", "1", "--out", str(out), *words])

    return run


def content(out: Path) -> dict[str, bytes]:
    """Return what must be the same in two folders of the same benchmark, but for the clock."""
    folder = out / "benchmark"
    figures = sorted((folder / "figures").iterdir())
    tables = (folder / "tables.md").read_text().splitlines()
    timeless = [line.rpartition(" | ")[0] if "| reactive" in line else line for line in tables]
    held = {path.name: path.read_bytes() for path in [*figures, folder / "episodes.csv"]}
    return held | {"tables.md": "\n".join(timeless).encode()}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a benchmark that nothing interrupted; the first test fills it."""
    return tmp_path_factory.mktemp("whole")


def test_all_that_is_promised_is_written(
    call: Call, whole: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call("--json", out=whole) == 0
    told = json.loads(capsys.readouterr().out)
    assert set(told) == {"small"} and list(told["small"]) == list(AGENTS)
    learner = told["small"]["reactive_planner:tuned"]
    assert learner["success_rate"]["count"] == 2 and 0 <= learner["spl"]["iqm"] <= 1
    folder = whole / "benchmark"
    rows = list(csv.DictReader((folder / "runs.csv").read_text().splitlines()))
    assert len(rows) == 4 and {row["experiment"] for row in rows} == {"small"}
    table = pq.read_table(folder / "runs.parquet")
    assert table.num_rows == 4
    assert table.column("spl").to_pylist() == [float(row["spl"]) for row in rows]
    assert pq.read_table(folder / "episodes.parquet").num_rows == 4 * 2
    names = {path.name for path in (folder / "figures").iterdir()}
    for name in ("intervals_spl", "intervals_success_rate", "profiles_spl", "efficiency_small"):
        assert {f"{name}.pdf", f"{name}.png"} <= names
    tables = (folder / "tables.md").read_text()
    assert "## small: driving" in tables and "## small: learning" in tables
    page = (whole / "benchmark.html").read_text()
    assert page.count("data:image/png") == 4 and "nomad-mj benchmark --agents straight" in page


def test_learners_are_checked_from_the_beginning_and_after_each_pass(whole: Path) -> None:
    path = next((whole / "benchmark" / "runs").glob("*reactive-planner*_0000.json"))
    held = json.loads(path.read_text())
    curve = held["curve"]
    assert curve[0]["decisions"] == 0 and curve[0]["unaided_success_rate"] == 0
    assert curve[-1]["decisions"] == held["row"]["learn_decisions"] >= 1
    decisions = [entry["decisions"] for entry in curve]
    assert decisions == sorted(decisions) and len(curve) >= 2
    assert held["row"]["learn_solved_all"] == (held["row"]["decisions_to_test"] is not None)
    assert 0 <= held["row"]["barn_score"] <= 0.25


def test_a_second_call_does_nothing_but_read(call: Call, whole: Path) -> None:
    runs = whole / "benchmark" / "runs"
    before = {path: path.stat().st_mtime_ns for path in runs.iterdir()}
    page = (whole / "benchmark.html").read_bytes()
    assert call("--only-read", out=whole) == 0
    assert {path: path.stat().st_mtime_ns for path in runs.iterdir()} == before
    assert (whole / "benchmark.html").read_bytes() == page


def test_killed_and_started_again_it_makes_the_same_tables(
    call: Call, whole: Path, small_room: Path, tmp_path: Path
) -> None:
    words = ["benchmark", "--agents", *AGENTS, "--rooms", str(small_room), *SMALL, "--curves"]
    words += ["--jobs", "1", "--out", str(tmp_path)]
    process = subprocess.Popen(
        [sys.executable, "-m", "nomad_agents.cli.main", *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    runs = tmp_path / "benchmark" / "runs"
    began = time.monotonic()
    while not list(runs.glob("*.json")):
        assert time.monotonic() - began < 120 and process.poll() is None
        time.sleep(0.01)
    process.kill()
    assert process.wait(timeout=30) == -signal.SIGKILL
    assert not (tmp_path / "benchmark.html").exists() and len(list(runs.glob("*.json"))) < 4
    assert call(out=tmp_path) == 0
    assert content(tmp_path) == content(whole)


def test_a_quick_look_takes_what_is_said_though_it_be_the_usual(
    small_room: Path, tmp_path: Path
) -> None:
    words = ["--quick", "--rooms", str(small_room), "--agents", "straight", "--seeds", "3"]
    assert main(["benchmark", *words, "--jobs", "1", "--out", str(tmp_path)]) == 0
    folder = tmp_path / "benchmark-quick"
    rows = list(csv.DictReader((folder / "runs.csv").read_text().splitlines()))
    assert [row["seed"] for row in rows] == ["0", "1", "2"]
    assert {row["starts"] for row in rows} == {"8"}  # of which nothing is said
    assert "--seeds 3 --quick" in (folder / "tables.md").read_text()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--agents", "nobody"], "unknown agent 'nobody'; there are: "),
        (["--sets", "flat"], "unknown set 'flat'; there are: concave, convex, maze"),
        (["--seeds", "0"], "seeds 0: must be 1 to 1000"),
        (["--jobs", "0"], "jobs 0: must be 1 or more"),
        (["--robots", "r2d2"], "unknown robot 'r2d2'"),
        (["--seeds", "3", "--only-read"], "holds no such run; run without --only-read"),
    ],
)
def test_mistakes_are_told_in_one_line(
    call: Call, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], told: str
) -> None:
    assert call(*words, out=tmp_path) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1
    assert not (tmp_path / "benchmark.html").exists()


def test_a_deep_learner_without_its_packages_is_told_in_one_line(
    call: Call,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(sys.modules, "stable_baselines3", None)  # as if it were not installed
    assert call("--agents", "sac", out=tmp_path) == 2
    error = capsys.readouterr().err
    assert "pip install 'nomad-mj[deep]'" in error and error.count("\n") == 1
