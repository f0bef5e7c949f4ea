"""The command line trains deep learners, and says what they cannot do."""

import json
from pathlib import Path

import pytest
from nomad_agents.cli import train_deep as command
from nomad_agents.cli.main import main
from nomad_agents.cli.progress import DeepProgress
from nomad_agents.deep.file import load_deep
from nomad_agents.deep.training import DeepTraining

ROBOT = ["--robot", "omnibot"]  # the one that is simulated fastest


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--agent", "sac", "--resume"], "--resume is no option of agent 'sac': its training can"),
        (["--agent", "ppo", "--max-passes", "3"], "--max-passes is no option of agent 'ppo'"),
        (["--agent", "td3", "--config", "tuned"], "--config is no option of agent 'td3'"),
        (["--decisions", "5"], "--decisions is no option of agent 'reactive_planner'"),
        (["--observation", "ranges"], "--observation is no option of agent 'reactive_planner'"),
        (["--agent", "sac", "--observation", "smell"], "must be one of: situation, ranges"),
        (["--agent", "sac", "--decisions", "0"], "decisions 0: must be 1 or more"),
        (["--agent", "sac", "--seed", "-1"], "seed -1: must be 0 or more"),
        (["--agent", "sca"], "unknown agent 'sca'; there are: CHECKPOINT.npz, "),
        (["--agent", "planner"], "try 'reactive_planner', or anew sac or td3 or ppo"),
    ],
)
def test_what_does_not_go_together_is_answered_in_one_line(
    arguments: list[str], told: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    pytest.importorskip("stable_baselines3")
    assert main(["train", *arguments, "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert told in said and said.startswith("nomad-mj: ") and said.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_train_writes_a_file_that_evaluate_drives(
    small_room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("stable_baselines3")
    place = ["--room", str(small_room), *ROBOT, "--range-noise", "0.1"]
    learnt = ["--agent", "td3", "--observation", "ranges", "--decisions", "30", "--seed", "2"]
    assert main(["train", *place, *learnt, "--out", str(tmp_path), "--json"]) == 0
    printed = capsys.readouterr()
    report = json.loads(printed.out)
    assert report["starts"] == 3 and report["decisions"] == 30 and report["wall_s"] > 0
    assert f"solved {report['solved']} of 3 starts after 30 decisions" in printed.err
    (path,) = tmp_path.iterdir()
    assert path.name == "small_omnibot_td3_ranges_2.npz"
    content = load_deep(path)
    assert (content.room, content.robot, content.training["seed"]) == ("small", "omnibot", 2)
    assert content.conditions["range_noise"] == 0.1
    driven = ["--agent", str(path), "--starts", "1", "--max-decisions", "2", "--json"]
    assert main(["evaluate", *place, *driven]) == 0
    assert json.loads(capsys.readouterr().out)["episodes"] == 1


def test_interrupted_it_leaves_what_was_learnt_so_far(
    small_room: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    pytest.importorskip("stable_baselines3")

    def interrupt(self: DeepProgress, training: DeepTraining) -> None:
        if training.decisions == 25:
            raise KeyboardInterrupt

    monkeypatch.setattr(command, "SAVE_EVERY", 20)
    monkeypatch.setattr(DeepProgress, "show", interrupt)
    path = tmp_path / "a.npz"
    place = ["--room", str(small_room), *ROBOT]
    assert main(["train", *place, "--agent", "sac", "--decisions", "30", "--out", str(path)]) == 130
    assert "interrupted" in capsys.readouterr().err
    assert load_deep(path).training["decisions"] == 20
