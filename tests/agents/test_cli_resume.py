"""Training that is killed, interrupted or refused to go on, through the command line."""

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from conftest import SmallRoom
from nomad_agents.checkpoint import load_checkpoint, save_checkpoint
from nomad_agents.cli.main import main

NOMAD = [sys.executable, "-W", "error", "-m", "nomad_agents.cli.main"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("resume")


@pytest.fixture(scope="module")
def whole(folder: Path, small_room: Path) -> Path:
    """Return the checkpoint of a training that nothing interrupted."""
    path = folder / "whole.npz"
    assert main(["train", "--room", str(small_room), "--out", str(path)]) == 0
    return path


def content(path: Path) -> dict[str, Any]:
    """Return all that a checkpoint holds, real time aside."""
    checkpoint = load_checkpoint(path)
    arrays = {name: array.tolist() for name, array in checkpoint.agent.network.arrays().items()}
    return {**arrays, **checkpoint.training, "wall_s": 0.0, "plans": checkpoint.agent.plannings}


def interrupted(command: list[str], path: Path, number: int, after: float) -> tuple[int, str]:
    """Start a command, signal it some time after it wrote its first checkpoint."""
    before = path.stat().st_mtime_ns if path.exists() else 0
    process = subprocess.Popen(
        command,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        # A shell lets what it runs in the background ignore Ctrl-C, and so would this.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    began = time.monotonic()
    while not path.exists() or path.stat().st_mtime_ns == before:
        assert time.monotonic() - began < 60 and process.poll() is None
        time.sleep(0.001)
    time.sleep(after)
    process.send_signal(number)
    _, told = process.communicate(timeout=60)
    return process.returncode, told


def test_killed_and_interrupted_it_ends_with_the_same_bits(
    folder: Path, whole: Path, small_room: Path
) -> None:
    path = folder / "part.npz"
    command = [*NOMAD, "train", "--room", str(small_room), "--out", str(path), "--resume"]
    endings = [
        interrupted(command, path, number, after)
        for number, after in ((signal.SIGKILL, 0.01), (signal.SIGINT, 0.0), (signal.SIGTERM, 0.0))
    ]
    told = "nomad-mj: interrupted\n"
    assert endings == [(-signal.SIGKILL, ""), (130, told), (130, told)]
    assert not load_checkpoint(path).training["done"]
    assert main([*command[len(NOMAD) :]]) == 0
    assert content(path) == content(whole)
    assert sorted(file.name for file in folder.iterdir()) == ["part.npz", "whole.npz"]


def test_resuming_what_is_done_changes_nothing(whole: Path, small_room: Path) -> None:
    before = content(whole)
    arguments = ["train", "--room", str(small_room), "--out", str(whole), "--resume"]
    assert main(arguments) == 0
    assert content(whole) == before


def other_runs(small_room: Path) -> Iterator[tuple[list[str], str]]:
    yield ["--room", str(small_room), "--seed", "1"], "it is of another seed: 0, not 1"
    yield ["--room", str(small_room), "--config", "tuned"], "it is of another config"
    yield ["--room", "empty_room"], "it is of another room: small, not empty_room"
    robot = ["--robot", "nomad200_wheels"]
    yield ["--room", str(small_room), *robot], "of another robot: nomad200, not nomad200_wheels"


def test_other_trainings_are_not_gone_on_with(
    whole: Path, small_room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = whole.read_bytes()
    for arguments, told in other_runs(small_room):
        assert main(["train", *arguments, "--out", str(whole), "--resume"]) == 2
        said = capsys.readouterr().err
        assert told in said and said.count("\n") == 1
        assert whole.read_bytes() == before


@pytest.mark.parametrize(
    "wrong", [{"passes": -5}, {"passes": 0}, {"solved": -3}, {"solved": 3, "tested": 2}]
)
def test_a_state_that_there_cannot_be_is_refused(
    whole: Path,
    small_room: Path,
    tmp_path: Path,
    wrong: dict[str, int],
    capsys: pytest.CaptureFixture[str],
) -> None:
    held = load_checkpoint(whole)
    path, state = tmp_path / "a.npz", {**held.training, "done": False, **wrong}
    save_checkpoint(path, held.agent, held.room, held.robot, state, held.conditions)
    assert main(["train", "--room", str(small_room), "--out", str(path), "--resume"]) == 2
    told = capsys.readouterr().err
    assert "holds no state of training" in told and told.count("\n") == 1


def test_nor_in_a_room_that_has_been_changed(
    own_room: SmallRoom, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    room, path = own_room(), str(tmp_path / "a.npz")
    arguments = ["train", "--max-decisions", "2", "--out", path, "--resume", "--room", str(room)]
    assert main(arguments) == 0
    capsys.readouterr()
    room.write_text(room.read_text().replace("</worldbody>", "<geom size='.1'/></worldbody>"))
    assert main(arguments) == 2
    told = capsys.readouterr().err
    assert "the file of its room has changed since" in told and told.count("\n") == 1


def test_nor_with_other_sensors_under_the_same_name(
    ring_robot: SmallRoom,
    own_room: SmallRoom,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    room, path = str(own_room()), str(tmp_path / "a.npz")
    arguments = ["train", "--room", room, "--max-decisions", "2", "--out", path, "--resume"]
    assert main([*arguments, "--robot", str(ring_robot())]) == 0
    capsys.readouterr()
    assert main([*arguments, "--robot", str(ring_robot(range(0, 360, 90)))]) == 2
    told = capsys.readouterr().err
    assert "it is of another set of sensors" in told and told.count("\n") == 1


def test_a_corrupt_checkpoint_is_not_resumed_nor_overwritten(
    small_room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(b"not a checkpoint")
    assert main(["train", "--room", str(small_room), "--out", str(path), "--resume"]) == 2
    assert "is corrupt or no checkpoint" in capsys.readouterr().err
    assert path.read_bytes() == b"not a checkpoint"


def test_what_was_learnt_is_not_lost_to_the_same_command(
    whole: Path, small_room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = whole.read_bytes()
    arguments = ["train", "--room", str(small_room), "--out", str(whole)]
    for more, told in (([], "is there already: --resume goes on"), (["--agent", "td3"], "already")):
        assert main([*arguments, *more]) == 2
        said = capsys.readouterr().err
        assert told in said and "--overwrite" in said and said.count("\n") == 1
    assert main([*arguments, "--resume", "--overwrite"]) == 2
    assert whole.read_bytes() == before


def test_a_checkpoint_to_go_on_from_that_is_not_there_is_told_of(
    small_room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["train", "--room", str(small_room), "--out", str(tmp_path / "a.npz"), "--resume"]
    assert main([*arguments, "--max-decisions", "1"]) == 0
    assert "a.npz: training begins anew" in capsys.readouterr().out


def test_to_overwrite_is_to_begin_anew(small_room: Path, tmp_path: Path) -> None:
    arguments = ["train", "--room", str(small_room), "--out", str(tmp_path / "a.npz")]
    arguments.append("--overwrite")
    made: list[int] = []
    for decisions in (30, 1):
        assert main([*arguments, "--max-decisions", str(decisions)]) == 0
        made.append(load_checkpoint(tmp_path / "a.npz").training["decisions"])
    assert made[0] >= 30 > made[1]


def test_a_full_disk_is_one_line_and_keeps_the_old_file(
    whole: Path, small_room: Path, tmp_path: Path
) -> None:
    path = tmp_path / "a.npz"
    path.write_bytes(whole.read_bytes())

    def few_bytes() -> None:  # what a full disk does, to every file of this process
        resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024))

    command = [*NOMAD, "train", "--room", str(small_room), "--out", str(path)]
    ended = subprocess.run(
        [*command, "--max-decisions", "2", "--overwrite"],
        preexec_fn=few_bytes,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
    )
    assert (ended.returncode, ended.stderr) == (
        2,
        f"nomad-mj: cannot write {str(path)!r}: File too large\n",
    )
    assert path.read_bytes() == whole.read_bytes()
    assert [file.name for file in tmp_path.iterdir()] == ["a.npz"]


@pytest.mark.parametrize("arguments", [["list", "--json"], ["list"], ["train", "--help"]])
def test_who_stops_reading_causes_no_traceback(arguments: list[str]) -> None:
    reader, writer = os.pipe()
    os.close(reader)
    ended = subprocess.run(
        [*NOMAD, *arguments], stdout=writer, stderr=subprocess.PIPE, text=True, check=False
    )
    os.close(writer)
    assert "Traceback" not in ended.stderr and "Exception" not in ended.stderr, ended.stderr
    assert ended.returncode in (0, 1)


def test_a_room_that_has_lost_starts_is_refused(
    tmp_path: Path, small_room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    room, path = tmp_path / "small.xml", tmp_path / "a.npz"
    text = small_room.read_text()
    room.write_text(text)
    command = ["train", "--room", str(room), "--out", str(path), "--max-decisions", "1"]
    assert main(command) == 0
    checkpoint = load_checkpoint(path)
    state = {**checkpoint.training, "next_start": 2, "testing": False}
    save_checkpoint(path, checkpoint.agent, checkpoint.room, checkpoint.robot, state)
    room.write_text(text.replace('<site name="start_2" pos="-2.5 1 0"/>', ""))
    capsys.readouterr()
    assert main([*command[:-2], "--resume"]) == 2
    assert "it is of a room with more starts than 2" in capsys.readouterr().err
    assert main([*command[:-2], "--resume", "--agent", "planner"]) == 2
    assert "--agent 'planner': --resume goes on with the agent in --out" in capsys.readouterr().err
