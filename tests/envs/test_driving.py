"""A move's control steps: what is ahead, what is touched, and what goes wrong on the way."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from dm_control.rl.control import PhysicsError
from hypothesis import given
from hypothesis import strategies as st

from nomad_mj import Outcome, PathFinding, load
from nomad_mj.envs.driving import Driving, Lookout
from nomad_mj.errors import ConfigError, NomadError, UnknownNameError
from nomad_mj.motion import MotionConfig
from nomad_mj.types import FloatArray, RangeRing, SensorLayout, Travel


@pytest.fixture(scope="module")
def env() -> Iterator[PathFinding]:
    with load(room="paper_room", task_kwargs={"random": 0}) as made:
        yield made


@given(
    st.floats(-10, 10),
    st.floats(-10, 10),
    st.sampled_from([0.0, 30.0, 45.0, 67.5, 90.0, 120.0, 180.0]),
)
def test_slack_is_none_ahead_a_little_beside_and_endless_behind(
    env: PathFinding, heading: float, sensors: float, ahead: float
) -> None:
    layout, config = env.scene.robot.layout, MotionConfig(ahead=math.radians(ahead))
    lookout = Lookout(layout, config)
    slack = lookout.slack(heading, sensors)
    for bearing, own in zip(np.concatenate([r.bearings for r in layout.rings]), slack, strict=True):
        off = abs(math.remainder(bearing + sensors - heading, 2 * math.pi))
        limits = (config.ahead, max(config.ahead, math.pi / 2))
        if min(abs(off - limit) for limit in limits) < 1e-6:
            continue
        assert own == (0.0 if off < limits[0] else config.beside if off < limits[1] else math.inf)
    many = lookout.slacks(np.array([heading, 0.0]), np.array([sensors, -1e-17]))
    np.testing.assert_array_equal(many, [slack, lookout.slack(0.0, -1e-17)])


def test_each_side_is_as_far_off_as_its_own_sensors_can_tell() -> None:
    def arc(*degrees: int) -> tuple[float, ...]:
        return tuple(math.radians(bearing) for bearing in degrees)

    far = RangeRing("lidar", arc(-60, -30, 0, 30, 60), math.radians(16), 0.3, 8.0)
    near = RangeRing("infrared", arc(90, 150, 210, 270), math.radians(20), 0.0, 0.8)
    config = MotionConfig(ahead=math.radians(45))
    lookout = Lookout(SensorLayout(0.2, (far, near)), config)
    assert lookout.motion.security_distance == config.security_distance
    more = 1.1 * 0.3 - config.security_distance  # that the lidar cannot tell
    ahead = lookout.slack(0.0, 0.0)
    assert ahead[1:4] == pytest.approx(-more)  # nothing else looks there
    assert ahead[[0, 4, 5, 8]] == pytest.approx([config.beside - more] * 2 + [config.beside] * 2)
    assert np.isinf(ahead[6:8]).all()
    assert (lookout.slack(math.pi, 0.0)[6:8] == 0.0).all()


@pytest.mark.parametrize("sensors", [0.0, -0.0, math.pi / 2, -1e-17, 2 * math.pi])
def test_a_sensor_at_the_limit_counts_as_ahead(env: PathFinding, sensors: float) -> None:
    layout = env.scene.robot.layout
    slack = Lookout(layout, MotionConfig(ahead=math.radians(45))).slack(0.0, sensors)
    assert np.count_nonzero(slack == 0.0) == 5 * len(layout.rings)  # 22.5 degrees apart


def test_control_steps_of_a_move_are_those_of_the_motor_task(
    env: PathFinding, monkeypatch: pytest.MonkeyPatch
) -> None:
    commands: list[Any] = []
    told: list[dict[str, FloatArray]] = []
    advance = env.motor.advance

    def noted(command: Any) -> None:
        commands.append(command)
        advance(command)

    monkeypatch.setattr(env.motor, "advance", noted)
    monkeypatch.setattr(
        env, "on_control_step", lambda: told.append(dict(env.motor.told().observation))
    )
    env.reset(seed=3, start=0)
    env.step((1.0, 0.3))
    with load("motor", room="paper_room", task_kwargs={"ends_at_goal": False}) as twin:
        twin.reset(3, 0)
        for command, seen in zip(commands, told, strict=True):
            step = twin.step(command)
            for name, array in step.observation.items():
                np.testing.assert_array_equal(seen[name], array)
    assert len(told) > 20


@pytest.mark.parametrize("phase", [range(5, 8), range(0)])
def test_a_touch_counts_in_whatever_part_of_a_move(env: PathFinding, phase: range) -> None:
    lookout = Lookout(env.scene.robot.layout, MotionConfig())
    robot, motion = env.scene.robot, lookout.motion
    driving = Driving(np.array([0.0, 0.5]), robot, motion, (0, 0, 0, 0), False, False)
    heading = gone = 0.0
    for tick in range(200):
        command = driving.command(5.0)
        if command is None:
            break
        way, turn = command[0] * 0.05, command[1] * 0.05
        heading, gone = heading + turn, gone + way
        touched = tick in phase
        odometry = (0, 0, heading, 0)
        driving.take_in(Travel(way, 0.0, heading, 0.0), odometry, 5.0, touched, touched)
    done = driving.result()
    assert done.outcome is Outcome.MOVED and gone == pytest.approx(0.5, abs=0.01)
    assert done.contact == bool(phase)


@pytest.mark.parametrize("reported", [True, False])  # by bumpers that stick, or that fail
def test_what_is_touched_from_the_beginning_is_no_contact_of_the_move(
    env: PathFinding, reported: bool
) -> None:
    lookout = Lookout(env.scene.robot.layout, MotionConfig())
    robot, motion = env.scene.robot, lookout.motion
    driving = Driving(np.array([0.5, 0.0]), robot, motion, (0, 0, 0, 0), reported, True)
    for touched, contact in ((True, False), (False, False), (True, True), (False, True)):
        driving.command(5.0)
        driving.take_in(Travel(0.0, 0.0, 0.0, 0.0), (0, 0, 0, 0), 5.0, reported, touched)
        assert driving.result().contact == contact


@pytest.mark.parametrize("robot", ["nomad200", "pioneer", "omnibot", "racer"])
@pytest.mark.parametrize(("pressed", "outcome"), [(1, Outcome.MOVED), (2, Outcome.BUMPED)])
def test_only_one_more_bumper_ends_a_move_that_began_at_a_contact(
    robot: str, pressed: int, outcome: Outcome
) -> None:
    with load(robot=robot) as made:
        own, motion = made.scene.robot, Lookout(made.scene.robot.layout, MotionConfig()).motion
    driving = Driving(np.array([0.5, 0.0]), own, motion, (0, 0, 0, 0), 1, 1)
    slow = own.drive.limits.translate * 0.05 / 4
    for tick in range(400):
        if driving.command(5.0) is None:
            break
        way = slow if driving.result().outcome is Outcome.NONE else 0.0
        more = pressed if 8 <= tick < 12 else 1
        driving.take_in(Travel(way, 0.0, 0.0, 0.0), (0, 0, 0, 0), 5.0, more, more)
    assert driving.result().outcome is outcome
    assert driving.result().contact == (pressed == 2)


@pytest.mark.parametrize("robot", ["omnibot", "pioneer"])
def test_a_robot_at_a_wall_gets_away_from_it(robot: str) -> None:
    with load("path_finding", "empty_room", robot, {"random": 0}) as env:
        env.reset(seed=0, start=(5.0, 5.0))
        x0, _, _, _ = env.scene.shown_bounds
        place = x0 + 0.2 + env.scene.robot.layout.radius + 0.001
        env.motor.task.start_next_at((place + 0.1, 5.0, math.pi))
        env.reset()
        for _ in range(60):  # against the wall behind its back
            env.motor.step(env.scene.robot.drive.twist(0.2, 0.0, 0.0, env.motor.task.travel))
        assert env.motor.task.bumpers.any()
        goal = env.motor.task.goal - env.motor.task.odometry[:2]
        assert goal[0] > 0
        step = env.step((1.0, 0.0))
        assert step.observation["outcome"] == Outcome.MOVED, step.observation
        assert step.observation["driven"] > 0.5


def test_what_is_done_to_an_observation_changes_nothing(env: PathFinding) -> None:
    ends: list[FloatArray] = []
    for spoil in (False, True):
        step = env.reset(seed=5, start=1)
        for _ in range(2):
            if spoil:
                for array in step.observation.values():
                    array[...] = 0
            step = env.step((1.0, 0.0))
        ends.append(np.array(env.physics.pose()))
    np.testing.assert_array_equal(ends[0], ends[1])


@pytest.mark.parametrize(
    ("seed", "start", "error"),
    [(-1, (5.0, 4.0, 1.0), ConfigError), (7, "nowhere", UnknownNameError)],
)
def test_a_refused_reset_leaves_no_trace(
    env: PathFinding, seed: int, start: Any, error: type[NomadError]
) -> None:
    env.reset(seed=2)
    expected = env.reset().observation
    env.reset(seed=2)
    with pytest.raises(error):
        env.reset(seed, start)
    for name, array in env.reset().observation.items():
        np.testing.assert_array_equal(array, expected[name])


def test_after_a_move_that_fails_a_new_episode_begins(env: PathFinding) -> None:
    env.reset(seed=1, start=0)
    env.physics.data.qpos[0] = np.nan
    with pytest.raises(PhysicsError):
        env.step((1.0, 0.0))
    assert env.step((1.0, 0.0)).first()
    assert env.step((0.3, 0.0)).mid()


def test_control_steps_need_an_episode() -> None:
    with load("motor", environment_kwargs={"flat_observation": True}) as motor:
        command = np.zeros(3)
        with pytest.raises(RuntimeError, match=r"no episode is under way: reset\(\) begins one"):
            motor.advance(command)
        first = motor.reset(0, 0)
        assert motor.told().first()
        motor.advance(command)
        step = motor.told()
        assert step.mid() and step.reward is not None
        assert step.observation.keys() == first.observation.keys()
