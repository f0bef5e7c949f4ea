"""``nomad-mj reproduce`` as its users call it, in a room that is learnt in seconds."""

import csv
import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import mujoco
import pytest
from nomad_agents.cli.main import main

Call = Callable[..., int]
EXPERIMENT = "fig7"


@pytest.fixture
def call(small_room: Path) -> Call:
    """Return a caller of the command in the small room, without videos."""

    def run(*words: str, out: Path) -> int:
        room = ["--room", str(small_room), "--config", "tuned", "--no-videos", "--out", str(out)]
        return main(["reproduce", *words, *room, "--jobs", "1"])

    return run


def content(out: Path) -> dict[str, bytes]:
    """Return what must be the same in two folders of the same study."""
    folder = out / "reproduce" / "tuned"
    figures = sorted((folder / "figures").iterdir())
    return {path.name: path.read_bytes() for path in [folder / "tables.md", *figures]}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a study that nothing interrupted; the first test fills it."""
    return tmp_path_factory.mktemp("whole")


def test_all_that_is_promised_is_written(
    call: Call, whole: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call(EXPERIMENT, "--seeds", "2", "--json", out=whole) == 0
    told = json.loads(capsys.readouterr().out)
    numbers = told[EXPERIMENT]["numbers"]["share of places with a suitable action"]
    assert numbers["reactive_planner"]["count"] == 2 and 0 <= numbers["planner"]["median"] <= 1
    folder = whole / "reproduce" / "tuned"
    every = list(csv.DictReader((folder / "runs.csv").read_text().splitlines()))
    rows = [row for row in every if row["experiment"] == EXPERIMENT]
    assert len(every) == len(rows) + 2, "and the trainings"
    assert [row["seed"] for row in rows if row["agent"] == "reactive_planner"] == ["0", "1"]
    assert {row["mujoco"] for row in rows} == {mujoco.__version__}
    report = (whole / "report.html").read_text()
    assert "nomad-mj reproduce fig7 --seeds 2" in report and "data:image" in report
    assert "Videos were not asked for." in report
    assert {path.suffix for path in (folder / "figures").iterdir()} == {".pdf", ".png"}


def test_a_second_call_does_nothing_but_read(call: Call, whole: Path) -> None:
    runs = whole / "reproduce" / "tuned" / "runs"
    before = {path: path.stat().st_mtime_ns for path in runs.rglob("*.*")}
    report = (whole / "report.html").read_bytes()
    assert call(EXPERIMENT, "--seeds", "2", out=whole) == 0
    assert call(EXPERIMENT, "--seeds", "2", "--only-read", out=whole) == 0
    assert {path: path.stat().st_mtime_ns for path in runs.rglob("*.*")} == before
    assert (whole / "report.html").read_bytes() == report


def test_what_is_there_of_more_is_told_as_a_part(
    call: Call, whole: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (whole / "report.html").read_bytes()
    assert call(EXPERIMENT, "--seeds", "9", "--only-read", out=whole) == 0
    assert "(5 of 13 runs so far)" in capsys.readouterr().out.replace("\n", " ")
    tables = (whole / "reproduce" / "tuned" / "tables.md").read_text()
    assert "(5 of 13 runs so far)" in tables
    assert call(EXPERIMENT, "--seeds", "2", "--only-read", out=whole) == 0
    assert (whole / "report.html").read_bytes() == before


def test_an_agent_that_is_lost_learns_again(call: Call, whole: Path) -> None:
    before = content(whole)
    (agent, *_) = sorted((whole / "reproduce" / "tuned" / "runs" / "agents").glob("training*.npz"))
    learnt = agent.read_bytes()
    agent.unlink()
    assert call(EXPERIMENT, "--seeds", "2", out=whole) == 0
    assert len(agent.read_bytes()) == len(learnt) and content(whole) == before


def test_interrupted_and_killed_and_started_again_it_makes_the_same_tables(
    call: Call, whole: Path, small_room: Path, tmp_path: Path
) -> None:
    words = ["reproduce", EXPERIMENT, "--seeds", "2", "--room", str(small_room)]
    words += ["--config", "tuned", "--no-videos", "--out", str(tmp_path), "--jobs", "1"]
    runs = tmp_path / "reproduce" / "tuned" / "runs"

    def done() -> int:
        return len(list(runs.glob("*.json")))

    for number, enough in ((signal.SIGINT, 1), (signal.SIGKILL, 3)):
        process = subprocess.Popen(
            [sys.executable, "-m", "nomad_agents.cli.main", *words],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            # A shell lets what it runs in the background ignore Ctrl-C, and so would this.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )
        began = time.monotonic()
        while done() < enough:
            assert time.monotonic() - began < 120 and process.poll() is None
            time.sleep(0.01)
        process.send_signal(number)
        assert process.wait(timeout=30) in (130, -number)
        assert not (tmp_path / "report.html").exists() and done() < 7
    assert call(EXPERIMENT, "--seeds", "2", out=tmp_path) == 0
    assert content(tmp_path) == content(whole)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["fig77"], "unknown experiment 'fig77'; there are: ablations, all, fig10, fig11"),
        (["fig6", "--seeds", "0"], "seeds 0, jobs 1: must be 1 or more"),
        (["fig6", "--config", "best"], "unknown configuration 'best'; there are: faithful, tuned"),
        (["fig6", "--only-read"], "holds no experiment of fig6 with a run of every case"),
    ],
)
def test_mistakes_are_told_in_one_line(
    call: Call, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], told: str
) -> None:
    if "--config" in words:
        assert main(["reproduce", *words, "--out", str(tmp_path)]) == 2
    else:
        assert call(*words, out=tmp_path) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1
    assert not (tmp_path / "report.html").exists()


def test_a_damaged_result_is_named(
    call: Call, whole: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    runs = whole / "reproduce" / "tuned" / "runs"
    path = next(runs.glob("fig7*planner*.json"))
    held = path.read_bytes()
    path.write_bytes(held[:100])
    try:
        assert call(EXPERIMENT, "--seeds", "2", "--only-read", out=whole) == 2
    finally:
        path.write_bytes(held)
    assert path.name in capsys.readouterr().err


def test_out_may_not_be_a_file(
    call: Call, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("mine")
    assert call(EXPERIMENT, "--seeds", "1", out=tmp_path / "file") == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert (tmp_path / "file").read_text() == "mine"
