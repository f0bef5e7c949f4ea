"""The command line: help, what --json prints, every mistake in one line."""

import csv
import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import fields
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from conftest import SmallRoom
from nomad_agents.cli import bench
from nomad_agents.cli.bench import Bench
from nomad_agents.cli.demo import Demo
from nomad_agents.cli.evaluate import METRICS, Evaluate
from nomad_agents.cli.listing import List
from nomad_agents.cli.main import main
from nomad_agents.cli.record import Record
from nomad_agents.cli.train import Train
from nomad_agents.cli.view import View
from nomad_agents.registry import AGENTS

GOLDEN = str(Path(__file__).parent / "data" / "checkpoint_v1.npz")
COMMANDS: dict[str, type[Any]] = {
    "train": Train,
    "evaluate": Evaluate,
    "record": Record,
    "view": View,
    "list": List,
    "bench": Bench,
    "demo": Demo,
}
TRAIN_KEYS = [
    *("solved", "starts", "reactions", "plannings", "virtual_collisions", "bumper_contacts"),
    *("categories", "exemplars", "passes", "wall_s", "sim_s"),
]


class Said(NamedTuple):
    """What a command printed."""

    code: int
    out: str
    err: str


Run = Callable[..., Said]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """Return a runner of commands within this process."""

    def command(*arguments: object) -> Said:
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as error:
            code = int(error.code or 0)
        printed = capsys.readouterr()
        return Said(code, printed.out, printed.err)

    return command


def refused(said: Said) -> str:
    """Return the one line that a mistake is answered with."""
    assert said.code == 2, said
    assert said.err.startswith("nomad-mj: ") and said.err.count("\n") == 1, said.err
    return said.err


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_every_option_with_its_default(
    run: Run, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    said = run(command, "--help")
    assert said.code == 0 and said.err == ""
    for option in fields(COMMANDS[command]):
        name = f"--{option.name.replace('_', '-')}"
        (told,) = re.findall(rf"(?ms)^\W*{name} .*?\(default: (.*?)\)", said.out)
        assert told == (str(option.default) or "''")


def test_help_lists_the_commands(run: Run) -> None:
    said = run("--help")
    assert said.code == 0 and all(f" {command} " in said.out for command in COMMANDS)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ("nothing", "unknown command 'nothing'; there are: bench, benchmark, check, demo, "),
        ("", "the command must come first, one of: train, evaluate, "),
        ("--json train", "the command must come first, one of: train, "),
        ("train --no-such-option", "train: unknown option '--no-such-option'; there are: --room "),
        ("train --sed 3", "train: unknown option '--sed'; did you mean --seed?"),
        ("evaluate --gaol 3,4", "evaluate: unknown option '--gaol'; did you mean --goal?"),
        ("train --width 9", "train: unknown option '--width'; there are: "),
        ("train more", "train: takes no argument 'more'; options are: --room "),
        ("train --json=maybe", "train: takes no argument 'maybe'"),
        ("train --seed", "train: Missing value for argument '--seed'"),
        ("train --seed x", "train: --seed 'x': must be a whole number"),
        ("train --seed 1.5", "train: --seed '1.5': must be a whole number"),
        ("record --fps often", "record: --fps 'often': must be a number"),
        ("record --fps=a:\u2500\u2500\u2500", "record: --fps"),
    ],
)
def test_what_is_no_command_is_answered_in_one_line(run: Run, arguments: str, told: str) -> None:
    assert told in refused(run(*arguments.split()))


def test_a_choice_that_there_is_not_lists_those_there_are(run: Run) -> None:
    told = refused(run("reproduce", "no-such-experiment"))
    assert "no-such-experiment" in told and "fig6" in told


@pytest.mark.parametrize(("columns", "encoding"), [("20", "utf-8"), ("300", "ascii")])
def test_it_is_one_line_on_any_terminal(columns: str, encoding: str) -> None:
    ended = subprocess.run(
        [sys.executable, "-m", "nomad_agents.cli.main", "train", "--seed", "x"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "COLUMNS": columns, "PYTHONIOENCODING": encoding},
    )
    assert ended.returncode == 2 and ended.stdout == ""
    assert ended.stderr == "nomad-mj: train: --seed 'x': must be a whole number\n"


def test_an_unknown_configuration_lists_those_there_are(run: Run) -> None:
    said = run("train", "--config", "best")
    assert said.code == 2 and "faithful" in said.err and "tuned" in said.err


def test_train_prints_one_line_of_json_last(run: Run, small_room: Path, tmp_path: Path) -> None:
    path = tmp_path / "new" / "a.npz"
    said = run("train", "--room", small_room, "--max-decisions", 5, "--out", path, "--json")
    report = json.loads(said.out)  # the only line: the rest is for people, on standard error
    assert said.code == 0 and list(report) == TRAIN_KEYS and report["starts"] == 3
    assert report["reactions"] > 0 and report["sim_s"] > 0 and report["wall_s"] > 0
    assert re.search(r"stopped, having solved \d of 3 starts, after \d+ decisions: ", said.err)
    assert [file.name for file in path.parent.iterdir()] == ["a.npz"]


def test_train_names_its_file_in_a_folder(run: Run, small_room: Path, tmp_path: Path) -> None:
    said = run("train", "--room", small_room, "--max-decisions", 2, "--seed", 4, "--out", tmp_path)
    assert said.code == 0 and said.err == ""
    assert [file.name for file in tmp_path.iterdir()] == [
        "small_nomad200_reactive_planner_faithful_4.npz"
    ]


@pytest.mark.parametrize("agent", [*AGENTS, GOLDEN])
def test_evaluate_prints_one_line_of_json_last(run: Run, agent: str) -> None:
    said = run(
        "evaluate", "--agent", agent, "--starts", 2, "--max-decisions", 4, "--seed", 3, "--json"
    )
    report = json.loads(said.out)
    assert said.code == 0 and list(report) == list(METRICS) and report["episodes"] == 2


def test_a_metric_of_no_episode_is_null(run: Run, tmp_path: Path) -> None:
    (tmp_path / "s").write_text("1,1")
    said = run("evaluate", "--starts", tmp_path / "s", "--max-decisions", 1, "--json")
    report = json.loads(said.out)
    assert report["success_rate"] == 0.0
    assert report["path_ratio_median"] is None and report["mean_time_s"] is None


def test_evaluate_writes_a_row_an_episode(run: Run, tmp_path: Path) -> None:
    (tmp_path / "starts").write_text("5,3.3,0.5\n1.2,4.4\n")
    out = tmp_path / "rows.csv"
    said = run("evaluate", "--starts", tmp_path / "starts", "--max-decisions", 2, "--out", out)
    assert said.code == 0 and "SPL" in said.out
    rows = list(csv.DictReader(out.read_text().splitlines()))
    assert [(float(r["x"]), float(r["heading"])) for r in rows] == [(5.0, 0.5), (1.2, 0.0)]
    assert all(float(r["shortest"]) > 1 and r["reached"] == "0" for r in rows)


def test_list_names_everything(run: Run) -> None:
    found = json.loads(run("list", "--json").out)
    assert list(found) == ["rooms", "robots", "tasks", "agents", "learners", "configs"]
    assert "paper_room" in found["rooms"] and found["configs"] == ["faithful", "tuned"]
    assert all(name in run("list").out for names in found.values() for name in names)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["train", "--room", "attic"], "unknown room 'attic'; there are: clutter, concave_room"),
        (["evaluate", "--robot", "r2d2"], "unknown robot 'r2d2'; there are: khepera, nomad"),
        (["train", "--agent", "x"], "unknown agent 'x'; there are: CHECKPOINT.npz, dwa, planner, "),
        (
            ["evaluate", "--agent", "x"],
            "unknown agent 'x'; there are: CHECKPOINT.npz, dwa, planner, ",
        ),
        (["record", "--agent", "no.npz"], "checkpoint 'no.npz' does not exist"),
        (["train", "--agent", "planner"], "agent 'planner' does not learn; try 'reactive_planner'"),
        (["train", "--agent", "straight"], "agent 'straight' does not learn"),
        (["train", "--room", "no/such.xml"], "room file 'no/such.xml' does not exist"),
        (["train", "--seed", "-1"], "seed -1: must be 0 or more"),
        (["train", "--max-passes", "0"], "max_passes 0: must be 1 or more"),
        (["train", "--max-decisions", "-1"], "max_decisions -1: must be 0 (no limit) or more"),
        (["evaluate", "--starts", "0"], "starts 0, seed 0: must be at least 1 and 0"),
        (["evaluate", "--starts", "-4"], "starts -4, seed 0: must be at least 1 and 0"),
        (["evaluate", "--starts", "2", "--seed", "-1"], "seed -1: must be 0 or more"),
        (["record", "--starts", "any.csv", "--seed", "-1"], "seed -1: must be 0 or more"),
        (["evaluate", "--starts", "1", "--max-decisions", "0"], "max_decisions 0: must be"),
        (["record", "--starts", "1", "--max-decisions", "0"], "max_decisions 0: must be 1"),
        (["demo", "--videos", "-1"], "videos -1: must be 0 or more"),
        (["demo", "--starts", "0"], "starts 0: must be 1 or more"),
        (["demo", "--speed", "0"], "speed 0.0: must be from 0.01 to 1000"),
        (["evaluate", "--starts", "no.csv"], "'no.csv' cannot be read: No such file or directory"),
        (["evaluate", "--starts", "²"], "starts file '²' cannot be read"),
        (["evaluate", "--starts", "9" * 5000], "cannot be read: File name too long"),
        (["evaluate", "--agent", "~nobody-there/a.npz"], "does not exist"),
        (["evaluate", "--agent", "a" * 300 + ".npz"], "cannot be read: File name too long"),
    ],
)
def test_mistakes_are_answered_in_one_line(
    run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, arguments: list[str], told: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert told in refused(run(*arguments))
    assert not any(path.is_file() for path in tmp_path.rglob("*"))  # nothing half-written


@pytest.mark.parametrize("command", ["train", "evaluate", "record"])
@pytest.mark.parametrize(
    ("out", "told"),
    [
        ("file/x", "cannot write 'file/x/"),
        ("a" * 300, "File name too long"),
        ("~nobody-there/x", "home directory"),
        ("{suffix}", "this writes "),
    ],
)
def test_places_that_cannot_be_written(
    run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, command: str, out: str, told: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("")
    wrong = {"train": "a.mp4", "evaluate": "a.npz", "record": "a.csv"}[command]
    assert told in refused(run(command, "--out", out.format(suffix=wrong)))
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_own_robots_and_rooms_by_path(
    run: Run, ring_robot: SmallRoom, own_room: SmallRoom, tmp_path: Path
) -> None:
    robot, room, path = ring_robot(), own_room(), tmp_path / "a.npz"
    files = ("--room", room, "--robot", robot, "--json")
    said = run("train", *files, "--max-decisions", 6, "--out", path)
    assert said.code == 0 and json.loads(said.out)["plannings"] > 0
    said = run("evaluate", *files, "--agent", path, "--starts", 2, "--max-decisions", 3)
    assert said.code == 0 and json.loads(said.out)["episodes"] == 2
    told = refused(run("evaluate", "--room", room, "--agent", path, "--starts", 1))
    assert "is for other sensors: 8 infrared to 1.5 m, radius 0.2 m; this robot has 16" in told


@pytest.mark.parametrize("name", ["my.room", "agent.v2", "lr0.001", "results.csv/"])
def test_a_folder_may_have_a_dot_in_its_name(run: Run, tmp_path: Path, name: str) -> None:
    said = run("evaluate", "--agent", "straight", "--starts", 1, "--max-decisions", 1, "--out",
               f"{tmp_path}/{name}")  # fmt: skip
    assert said.code == 0
    assert [path.suffix for path in (tmp_path / name).iterdir()] == [".csv"]


def test_a_version_is_told(run: Run) -> None:
    assert run("--version") == Said(0, f"nomad-mj {version('nomad-mj')}\n", "")


def test_names_that_a_terminal_cannot_show_do_no_harm(tmp_path: Path) -> None:
    (tmp_path / "zimmer-\u00fc.yaml").write_text("size: [6, 4]\n", encoding="utf-8")
    words = ["room", "zimmer-\u00fc.yaml", "-o", "zimmer-\u00fc.xml"]
    ended = subprocess.run(
        [sys.executable, "-m", "nomad_agents.cli.main", *words],
        capture_output=True,
        check=False,
        cwd=tmp_path,
        env={**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "1"},
    )
    assert (ended.returncode, ended.stderr) == (0, b"")
    assert ended.stdout.startswith(b"zimmer-\\xfc.xml: 6 x 4 m")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ("bench --soak-hours 3", "--soak-hours: only with --soak"),
        ("bench --soak --soak-hours inf", "hours inf: must be finite"),
        ("sweep agent=straight --metric spl room=clutter", "'room=clutter' follows --metric"),
        ("sweep rom=x --only-read", "--only-read shows all there is in --out"),
        ("sweep --only-read --out ~nobody-there/x", "home directory"),
        ("sweep --grid ~nobody-there/x.yaml", "home directory"),
        ("sweep agent=straight --starts \u00b2 --seeds 1", "starts file '\u00b2' cannot be read"),
        ("reproduce fig6 --out r.html", "out 'r.html': must be a folder"),
        ("evaluate --out a.gif", "this writes .csv; give such a file or a folder"),
        ("train --out a.NPZ", "this writes .npz; give such a file or a folder"),
        ("check pioneer --no-drve", "did you mean --no-drive?"),
        ("room maze --starts abc", "--starts 'abc': must be a whole number"),
        ("record --width 641", "picture 641 x 480: its width must be an even number"),
    ],
)
def test_options_that_would_be_ignored_or_fail_late_are_refused(
    run: Run, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, arguments: str, told: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert told in refused(run(*arguments.split()))


def test_the_demo_learns_compares_and_draws(run: Run, small_room: Path, tmp_path: Path) -> None:
    few = ("--starts", 2, "--videos", 0, "--out", tmp_path, "--json")
    said = run("demo", "--room", small_room, *few)
    told = json.loads(said.out)
    assert said.code == 0 and told["training"]["starts"] == 3
    assert list(told["unseen"]) == ["reactive_planner", "straight", "planner"]
    figures = {f"{name}.{end}" for name in ("fig6", "fig7") for end in ("png", "pdf")}
    assert {path.name for path in tmp_path.iterdir()} == {"small.npz", *figures}


def test_bench_tells_every_ratio(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    few: dict[str, dict[str, int]] = {
        "control_step_ratio": {"blocks": 1, "steps": 2},
        "training_ratio": {"decisions": 2},
        "decision_times": {"repeats": 2},
        "batch_ratio": {"blocks": 1, "steps": 1},
        "async_ratio": {"blocks": 1, "steps": 1},
        "perception_ratio": {"blocks": 1, "singles": 8},
        "simulated_rate": {"blocks": 1, "steps": 2},
    }
    for name, options in few.items():
        monkeypatch.setattr(bench, name, partial(getattr(bench, name), **options))
    monkeypatch.setattr(bench, "_FRAMES", 8)
    told = json.loads(run("bench", "--room", "empty_room", "--json").out)
    assert list(told) == list(bench.LIMITS)
    assert all(value is None or value > 0 for value in told.values())


def test_an_interruption_exits_130(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(self: List) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(List, "run", interrupt)
    assert run("list") == Said(130, "", "nomad-mj: interrupted\n")
