"""The options that say where the robot drives: what they do to the task, on file and resumed."""

import json
import math
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nomad_agents.checkpoint import load_checkpoint
from nomad_agents.cli.demo import Demo
from nomad_agents.cli.evaluate import Evaluate
from nomad_agents.cli.main import main
from nomad_agents.cli.record import Record
from nomad_agents.cli.train import Train
from nomad_agents.task_options import TaskOptions

from nomad_mj import (
    BumperNoise,
    Crosstalk,
    FiringOrder,
    Gyroscope,
    InfraredEffects,
    MotorConfig,
    OdometryNoise,
    RangeNoise,
    SonarEffects,
)
from nomad_mj.errors import CheckpointError, ConfigError, NomadError

GOLDEN = Path(__file__).parent / "data" / "checkpoint_v1.npz"
COMMANDS = (Train, Evaluate, Record, Demo)
Make = Callable[..., TaskOptions]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_that_drives_has_them_all(command: type[TaskOptions]) -> None:
    own = {field.name: field.default for field in fields(command)}
    assert {field.name: field.default for field in fields(TaskOptions)}.items() <= own.items()


def test_without_options_the_task_is_the_papers() -> None:
    with TaskOptions().path_finding() as env:
        config = env.motor.task.config
        assert config == MotorConfig(ends_at_goal=False)
        assert (env.scene.arena.name, env.scene.robot.name) == ("paper_room", "nomad200")


def test_errors_of_the_sensors_reach_the_task() -> None:
    options = TaskOptions(
        room="empty_room", range_noise=0.3, gaussian_noise=True, grazing=30.0, odometry_error=0.5
    )
    with options.path_finding() as env:
        config = env.motor.task.config
        assert config.range_noise == RangeNoise("gaussian", 0.3, grazing=math.radians(30))
        assert config.odometry_noise == OdometryNoise(position=0.5)


def test_what_sensors_suffer_reaches_the_task() -> None:
    options = TaskOptions(
        room="empty_room",
        sonar_per_step=2,
        spread_firing=True,
        crosstalk=0.2,
        dropout=0.1,
        infrared_by_colour=True,
        sticky_bumpers=0.5,
        heading_drift=3.0,
        gyroscope=True,
    )
    with options.path_finding() as env:
        assert env.motor.task.config == MotorConfig(
            sonar=SonarEffects(
                firing=FiringOrder(2, "spread"), crosstalk=Crosstalk(0.2), dropout=0.1
            ),
            infrared=InfraredEffects(),
            bumper_noise=BumperNoise(hold=0.5),
            odometry_noise=OdometryNoise(heading_per_metre=math.radians(3)),
            gyroscope=Gyroscope(),
            ends_at_goal=False,
        )
        env.reset(seed=0)
        env.step((0.0, 1.0))


def test_the_goal_and_what_moves_reach_the_task() -> None:
    with TaskOptions(goal="3.5,6", moving_goal=True, moving_obstacles=3).path_finding() as env:
        np.testing.assert_array_equal(env.scene.arena.goal, [3.5, 6.0])
        env.reset(seed=0)
        movers = env.motor.task.movers
        assert movers is not None and len(movers.obstacles) == 3
        for _ in range(3):
            env.step((0.0, 1.0))
        assert movers.goal[0] < 3.5 and env.motor.task.goal[0] == movers.goal[0]
    with TaskOptions().path_finding() as env:
        assert env.motor.task.movers is None


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"moving_obstacles": -1}, "count of moving obstacles -1: must be 0, 1, 2, ..."),
        ({"goal": "99,99"}, "goal"),
        ({"goal": "nan,1"}, "goal (nan, 1.0): must be (x, y) in metres"),
        ({"range_noise": 1.0}, "range noise level 1.0: must be in [0, 1)"),
        ({"grazing": 0.0}, "grazing 0: must be above 0 and at most 90 degrees"),
        ({"grazing": 91.0}, "grazing 91: must be above 0 and at most 90 degrees"),
        ({"grazing": math.nan}, "grazing nan: must be above 0"),
        ({"odometry_error": -0.1}, "odometry noise position -0.1: must be >= 0"),
        ({"sonar_per_step": -1}, "firing order per_step -1: must be 1, 2, 3, ..."),
        ({"spread_firing": True}, "spread firing: needs --sonar-per-step, how many fire together"),
        ({"crosstalk": 1.5}, "crosstalk probability 1.5: must be in [0, 1]"),
        ({"dropout": math.nan}, "sonar dropout nan: must be in [0, 1]"),
        ({"sticky_bumpers": -1.0}, "bumper noise hold -1.0: must be 0 s or more"),
        ({"odometry_error": math.inf}, "odometry noise position inf: must be >= 0"),
        ({"heading_drift": math.inf}, "odometry noise heading_per_metre inf: must be finite"),
        ({"goal": "8"}, "goal '8': must be X,Y in metres, such as 8,2.5"),
        ({"goal": "8,2,1"}, "goal '8,2,1': must be X,Y in metres"),
        ({"goal": "east"}, "goal 'east': must be X,Y in metres"),
    ],
)
def test_what_makes_no_sense_is_one_line(options: dict[str, Any], told: str) -> None:
    with pytest.raises(NomadError) as caught, TaskOptions(**options).path_finding():
        pass
    assert told in str(caught.value) and "\n" not in str(caught.value)


conditions = st.builds(
    TaskOptions,
    goal=st.sampled_from(["", "1,2", "1.5,-3"]),
    moving_goal=st.booleans(),
    moving_obstacles=st.integers(0, 2),
    range_noise=st.sampled_from([0.0, 0.15, 0.3]),
    gaussian_noise=st.booleans(),
    grazing=st.sampled_from([30.0, 90.0]),
    odometry_error=st.sampled_from([0.0, 0.5]),
    sonar_per_step=st.sampled_from([0, 4]),
    dropout=st.sampled_from([0.0, 0.1]),
    gyroscope=st.booleans(),
)


@given(conditions, conditions)
def test_training_goes_on_under_the_same_conditions_and_no_others(
    mine: TaskOptions, theirs: TaskOptions
) -> None:
    on_file = json.loads(json.dumps(theirs.conditions()))
    if mine == theirs:
        mine.require_same(on_file, "a.npz")
        return
    with pytest.raises(CheckpointError, match=r"^cannot resume 'a.npz': it was trained with --"):
        mine.require_same(on_file, "a.npz")


def test_conditions_are_told_apart_by_what_they_mean() -> None:
    one, other = TaskOptions(goal="8,2.50"), TaskOptions(goal=" 8.0, 2.5")
    assert one.conditions() == other.conditions()
    elsewhere = replace(one, room="clutter", robot="nomad200_wheels")
    assert elsewhere.conditions() == one.conditions()  # the checkpoint has names for these


def test_a_checkpoint_of_before_was_trained_under_the_usual_conditions() -> None:
    before = load_checkpoint(GOLDEN).conditions
    assert before == {}
    TaskOptions().require_same(before, "a.npz")
    with pytest.raises(CheckpointError, match=r"with --range-noise 0\.15, not 0\.2$"):
        TaskOptions(range_noise=0.2).require_same(before, "a.npz")


def test_resuming_under_other_conditions_is_refused(
    small_room: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.npz"
    common = ["train", "--room", str(small_room), "--out", str(path), "--max-decisions", "3"]
    noisy = ["--range-noise", "0.05", "--grazing", "40"]
    assert main([*common, *noisy]) == 0
    assert load_checkpoint(path).conditions["grazing"] == 40.0
    assert main([*common, *noisy, "--resume"]) == 0
    before = path.read_bytes()
    capsys.readouterr()
    assert main([*common, "--range-noise", "0.05", "--resume"]) == 2
    told = f"nomad-mj: cannot resume {str(path)!r}: it was trained with --grazing 40.0, not 90.0\n"
    assert capsys.readouterr().err == told
    assert path.read_bytes() == before
    assert (
        main([*common, "--agent", str(path), "--overwrite"]) == 0
    )  # but to learn on elsewhere is allowed


def evaluated(capsys: pytest.CaptureFixture[str], *options: str) -> dict[str, Any]:
    starts = ["--starts", "3", "--max-decisions", "12", "--json"]
    assert main(["evaluate", "--agent", "straight", *starts, *options]) == 0
    return json.loads(capsys.readouterr().out)


def test_evaluation_depends_on_them(capsys: pytest.CaptureFixture[str]) -> None:
    usual = evaluated(capsys, "--room", "empty_room")
    assert evaluated(capsys, "--room", "empty_room") == usual
    lost = evaluated(capsys, "--room", "empty_room", "--odometry-error", "2")
    assert lost["path_ratio_median"] is None or (
        lost["path_ratio_median"] > usual["path_ratio_median"] + 0.1
    )
    assert np.isclose(usual["success_rate"], 1.0)


def test_a_robot_without_sonar_loses_no_echoes(ring_robot: Callable[..., Path]) -> None:
    options = TaskOptions(room="empty_room", robot=str(ring_robot()), grazing=40.0)
    with pytest.raises(ConfigError, match=r"^specular ring 'sonar': the robot has no such ring"):
        options.path_finding().__enter__()
