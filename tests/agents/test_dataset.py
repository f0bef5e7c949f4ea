"""Episodes exported as a Minari dataset, read back and driven again."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from nomad_agents.cli.main import main

minari = pytest.importorskip("minari")
pytest.importorskip("h5py")


def same(one: Any, rows: Any, number: int) -> bool:
    if isinstance(one, dict):
        return all(np.array_equal(value, rows[name][number]) for name, value in one.items())
    return np.array_equal(one, rows[number])


@pytest.mark.parametrize("observation", ["dict", "situation"])
def test_a_dataset_drives_again_to_the_same_bits(
    small_room: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, observation: str
) -> None:
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    monkeypatch.chdir(small_room.parent)
    command = ["export", "--room", small_room.name, "--starts", "3", "--observation", observation]
    options = ["--moving-obstacles", "1", "--odometry-error", "0.2", "--max-decisions", "6"]
    assert main([*command, *options, "--dataset", "mine/deep/small-v0"]) == 0
    monkeypatch.chdir(tmp_path)
    assert list(minari.list_local_datasets()) == ["mine/deep/small-v0"]
    dataset: Any = minari.load_dataset("mine/deep/small-v0")
    env = dataset.recover_environment()
    assert dataset.total_episodes == 3
    told = list(dataset.storage.get_episode_metadata(range(3)))
    for episode, how in zip(dataset.iterate_episodes(), told, strict=True):
        seen, info = env.reset(seed=how["seed"], options=how["options"])
        assert 1 <= len(episode.actions) <= 6
        terminated = truncated = False
        for number, action in enumerate(episode.actions):
            assert same(seen, episode.observations, number) and same(info, episode.infos, number)
            seen, reward, terminated, truncated, info = env.step(action)
            assert reward == episode.rewards[number]
            assert terminated == episode.terminations[number]
            assert truncated == episode.truncations[number]
        assert terminated or truncated
        assert same(seen, episode.observations, -1) and same(info, episode.infos, -1)
    env.close()


def test_out_is_the_folder_of_all_datasets(
    small_room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["export", "--room", str(small_room), "--starts", "1", "--agent", "straight"]
    assert main([*command, "--out", str(tmp_path)]) == 0
    folder = tmp_path / "nomad_mj" / "small-nomad200-straight-v0"
    assert sorted(path.name for path in (folder / "data").iterdir()) == [
        "main_data.hdf5",
        "metadata.json",
    ]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["nomad_mj"]
    capsys.readouterr()
    assert main([*command, "--out", str(tmp_path)]) == 2
    assert "exists in" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--dataset", "no version"], "dataset 'no version': must be NAME-v0 or FOLDER/NAME-v0"),
        (["--dataset", "../up-v0"], "dataset '../up-v0': must be NAME-v0 or FOLDER/NAME-v0"),
        (["--out", "/dev/null"], "cannot write dataset"),
        (["--starts", "0"], "starts 0, seed 0: must be at least 1 and 0"),
        (["--agent", "pilot"], "unknown agent 'pilot'"),
    ],
)
def test_refusals_take_one_line(
    small_room: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    told: str,
) -> None:
    usual = ["--out", str(tmp_path), "--starts", "1", "--max-decisions", "1"]
    assert main(["export", "--room", str(small_room), *usual, *options]) == 2
    error = capsys.readouterr().err
    assert told in error and error.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("module", "extra", "command"),
    [
        ("minari", "minari", ["export"]),
        ("h5py", "minari", ["export"]),
        ("tensorboard.summary", "tensorboard", ["train", "--tensorboard", "curves"]),
    ],
)
def test_without_the_extra_a_line_says_how_to_install_it(
    module: str,
    extra: str,
    command: list[str],
    small_room: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    monkeypatch.chdir(tmp_path)
    assert main([*command, "--room", str(small_room), "--out", str(tmp_path)]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1 and f"pip install 'nomad-mj[{extra}]'" in told
    assert not list(tmp_path.iterdir())
