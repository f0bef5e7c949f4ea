"""TensorBoard's curves of a training, read back; interrupted, killed and resumed."""

import itertools
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from nomad_agents.checkpoint import load_checkpoint
from nomad_agents.cli.main import main
from nomad_agents.cli.train import Train
from nomad_agents.curves import Curves, read_curves
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.training import Training

pytest.importorskip("tensorboard")

Read = dict[str, list[tuple[int, float]]]


def run(small_room: Path, folder: Path, *more: str) -> int:
    common = ["--room", str(small_room), "--out", str(folder / "a.npz"), "--max-passes", "1"]
    return main(["train", *common, "--tensorboard", str(folder / "curves"), *more])


def curves_of(folder: Path) -> Read:
    (only,) = (folder / "curves").iterdir()
    return read_curves(only)


@pytest.fixture(scope="module")
def whole(small_room: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Read]:
    folder = tmp_path_factory.mktemp("whole")
    assert run(small_room, folder) == 0
    return folder, curves_of(folder)


def test_they_end_where_the_training_ends(whole: tuple[Path, Read]) -> None:
    folder, curves = whole
    checkpoint = load_checkpoint(folder / "a.npz")
    end, network = checkpoint.training, checkpoint.agent.network
    last = {tag: points[-1] for tag, points in curves.items()}
    for name in ("reactions", "plannings", "virtual_collisions", "bumper_contacts"):
        assert last[f"learning/{name}"] == (end["decisions"], end[name])
    assert last["learnt/categories"][1] == len(network.value)
    assert last["learnt/exemplars"][1] == len(network.category)
    assert last["test/solved_starts"] == (end["decisions"], end["solved"])
    lengths = [value for _, value in curves["episode/decisions"]]
    steps = [step for step, _ in curves["episode/decisions"]]
    assert np.cumsum(lengths).tolist() == steps
    rewards = [value for _, value in curves["episode/reward"]]
    assert all(-length <= z <= 0 for z, length in zip(rewards, lengths, strict=True))
    assert min(rewards) < 0


class Killed(BaseException):
    """What no one catches."""


def test_killed_after_any_episode_nothing_is_lost_and_nothing_twice(
    whole: tuple[Path, Read], small_room: Path, tmp_path: Path
) -> None:
    for episodes in (2, 5):  # while learning; in the test, whose checkpoint is that of the learning
        with pytest.MonkeyPatch.context() as patch, pytest.raises(Killed):
            patch.setattr(Curves, "add", killing(patch, episodes))
            run(small_room, tmp_path, "--resume")
    assert run(small_room, tmp_path, "--resume") == 0
    assert len(list((tmp_path / "curves").glob("*/*"))) == 3
    assert curves_of(tmp_path) == whole[1]


def nothing(*_: object) -> None:
    """Stand for what a process that is gone does not do."""


def killing(
    patch: pytest.MonkeyPatch, episodes: int
) -> Callable[[Curves, Training, ReactivePlanner], None]:
    """Return an `add` that ends everything, checkpoints too, after so many episodes."""
    add, counted = Curves.add, itertools.count(1)

    def add_or_die(self: Curves, training: Training, agent: ReactivePlanner) -> None:
        add(self, training, agent)
        if next(counted) == episodes:
            patch.setattr("nomad_agents.cli.train.save_checkpoint", nothing)
            raise Killed

    return add_or_die


def test_a_training_anew_begins_its_curves_anew(whole: tuple[Path, Read], small_room: Path) -> None:
    folder, curves = whole
    assert run(small_room, folder, "--overwrite") == 0
    assert curves_of(folder) == curves
    assert Train().tensorboard == ""


def test_another_training_leaves_them_alone(
    whole: tuple[Path, Read], small_room: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, curves = whole
    for more in ((), ("--resume",)):  # there is no such checkpoint to go on from
        assert run(small_room, folder, "--out", str(folder / "b.npz"), *more) == 2
        told = capsys.readouterr().err
        assert "holds the curves of a training already" in told and told.count("\n") == 1
    assert not (folder / "b.npz").exists() and curves_of(folder) == curves


def test_a_folder_that_cannot_be_written(
    small_room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "curves").write_text("")
    assert run(small_room, tmp_path) == 2
    error = capsys.readouterr().err
    assert error.startswith("nomad-mj: cannot write curves to ") and error.count("\n") == 1


def test_when_the_disk_is_full_the_agent_is_kept_and_it_is_told_in_a_line(
    small_room: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Full:
        def add_scalar(self, *_: object) -> None:
            raise OSError(28, "No space left on device")

        flush = close = add_scalar

    begin = Curves.begin

    def fills(self: Curves, training: Training) -> None:
        begin(self, training)
        monkeypatch.setattr(self, "_writer", Full())

    monkeypatch.setattr(Curves, "begin", fills)
    assert run(small_room, tmp_path) == 2
    error = capsys.readouterr().err.splitlines()[-1]
    assert error.startswith("nomad-mj: cannot write curves to ") and "No space left" in error
    assert load_checkpoint(tmp_path / "a.npz").training["decisions"] > 0
