"""The decision level: what a move does, how it ends and what is told of it."""

import math
from collections.abc import Iterator
from typing import Any

import dm_env
import numpy as np
import pytest

from nomad_mj import Outcome, PathFinding, PathFindingConfig, RangeNoise, load
from nomad_mj.geometry import direction, rotate
from nomad_mj.motion import ActionSpec, MotionConfig, displacement, reinforcement
from nomad_mj.types import FloatArray

QUIET = {"range_noise": RangeNoise("none")}
ROBOTS = ("nomad200", "nomad200_wheels")


def loaded(room: str = "empty_room", robot: str = "nomad200", **options: Any) -> PathFinding:
    time_limit = options.pop("time_limit", 1e4)
    return load(
        room=room,
        robot=robot,
        task_kwargs={"random": 0} | QUIET | options,
        environment_kwargs={"time_limit": time_limit},
    )


@pytest.fixture(scope="module", params=ROBOTS)
def env(request: pytest.FixtureRequest) -> Iterator[PathFinding]:
    made = loaded(robot=request.param)
    yield made
    made.close()


def place(env: PathFinding) -> FloatArray:
    return np.array(env.physics.pose()[:2])


def outcome(step: dm_env.TimeStep) -> Outcome:
    return Outcome(int(step.observation["outcome"]))


def towards(env: PathFinding, heading: float) -> FloatArray:
    """Return the action that drives along a heading in the world [rad]."""
    goal = env.scene.arena.goal - place(env)
    return rotate([1.0, 0.0], heading - direction(goal))


@pytest.mark.parametrize(
    "action", [(1, 0), (0, 1), (0, -1), (-1, 0), (0.5, 0.25), (1, 1), (-0.3, 0.6), (0.05, 0)]
)
def test_a_free_move_leads_where_the_action_says(
    env: PathFinding, action: tuple[float, float]
) -> None:
    env.reset(seed=0, start=(4.0, 3.0, 1.0))
    before = place(env)
    goal = env.scene.arena.goal - before
    step = env.step(action)
    wanted = displacement(action, goal, ActionSpec())
    np.testing.assert_allclose(place(env) - before, wanted, atol=0.015)
    seen = step.observation
    assert outcome(step) is Outcome.MOVED and step.mid()
    assert seen["driven"] == pytest.approx(np.hypot(*wanted), abs=0.012)
    np.testing.assert_allclose(seen["goal"], env.scene.arena.goal - place(env), atol=0.01)
    assert step.reward == pytest.approx(reinforcement(wanted, goal, seen["clearance"]), abs=1e-6)


def test_what_is_told_of_a_move_is_what_happened_tick_by_tick(env: PathFinding) -> None:
    ticks: list[dm_env.TimeStep] = []
    env.on_control_step = lambda: ticks.append(env.motor.told())
    for move, (x, y) in enumerate([(1, 0.2), (-0.4, 1), (0.3, 0.3)]):
        if move == 0:
            env.reset(seed=0, start=(2.0, 2.0))
            assert not ticks
        ticks.clear()
        before = env.physics.data.time
        seen = env.step((x, y)).observation
        assert seen["duration"] == pytest.approx(env.physics.data.time - before)
        assert seen["duration"] == pytest.approx(0.05 * len(ticks))
        driven = sum(abs(tick.observation["encoders"][0]) for tick in ticks)
        assert seen["driven"] == pytest.approx(driven)
        nearest = min(
            min(tick.observation["sonar"].min(), tick.observation["infrared"].min())
            for tick in ticks
        )
        assert seen["clearance"] == nearest
        for name in ("sonar", "infrared", "odometry", "goal"):
            np.testing.assert_array_equal(seen[name], ticks[-1].observation[name])
        # The turret keeps looking along +x, and the robot stands still after the move.
        assert max(abs(float(tick.observation["odometry"][3])) for tick in ticks) < 0.05
        assert abs(ticks[-1].observation["encoders"][0]) < 0.002
    env.on_control_step = None


@pytest.mark.parametrize("heading", [0.0, math.pi / 2, math.pi, -math.pi / 2, 2.6])
def test_before_a_wall_it_stops_retracts_and_says_so(env: PathFinding, heading: float) -> None:
    along = np.array([math.cos(heading), math.sin(heading)])
    start = 5 + along * 4.2 / np.abs(along).max()
    env.reset(seed=0, start=(*start.tolist(), heading))
    free = 0.8 - 0.265
    step = env.step(towards(env, heading))
    assert outcome(step) is Outcome.VIRTUAL_COLLISION
    assert -1 <= step.reward <= -0.5
    margin = env.config.motion.security_distance
    assert 0 < step.observation["clearance"] < margin
    assert not step.observation["bumpers"].any()
    back = float((place(env) - start) @ along)
    assert back * np.abs(along).max() == pytest.approx(
        free - margin - env.config.motion.retract * np.abs(along).max(), abs=0.08
    )
    away = env.step(towards(env, heading + math.pi))
    assert outcome(away) is Outcome.MOVED


def test_the_turret_is_turned_back_to_look_along_x(env: PathFinding) -> None:
    env.reset(seed=0, start=(4.0, 3.0))
    for _ in range(20):
        env.motor.step((0.0, 0.0, 0.6))
    assert env.physics.named.data.qpos["robot/turret"][0] > 0.4
    assert abs(env.step((1, 0)).observation["odometry"][3]) < 0.02


def test_a_contact_is_told_apart_and_left_again(env: PathFinding) -> None:
    reckless = PathFinding(
        env.motor, PathFindingConfig(motion=MotionConfig(security_distance=0.0, creep=0.1))
    )
    reckless.reset(seed=0, start=(0.8, 5.0, math.pi))
    step = reckless.step(towards(reckless, math.pi))
    assert outcome(step) is Outcome.BUMPED and step.reward <= -0.5
    assert step.observation["clearance"] < 0.01
    assert not step.observation["bumpers"].any() and place(reckless)[0] > 0.45
    assert outcome(reckless.step(towards(reckless, 0.0))) is Outcome.MOVED


def test_a_move_out_of_time_is_stopped(env: PathFinding) -> None:
    hasty = PathFinding(env.motor, PathFindingConfig(motion=MotionConfig(time_out=1.5)))
    hasty.reset(seed=0, start=(4.0, 3.0, 0.0))
    step = hasty.step((1, 0))
    assert outcome(step) is Outcome.TIMED_OUT
    assert 1.5 <= step.observation["duration"] <= 1.5 + 2.0
    assert abs(step.observation["encoders"][0]) < 0.002


def test_the_goal_ends_the_episode_with_discount_0(env: PathFinding) -> None:
    goal = env.scene.arena.goal
    first = env.reset(seed=0, start=(goal[0] - 0.9, goal[1] - 0.9))
    assert first.first() and outcome(first) is Outcome.NONE
    nearest = min(first.observation["sonar"].min(), first.observation["infrared"].min())
    assert first.observation["clearance"] == nearest and first.observation["duration"] == 0
    steps = [env.step((1, 0))]
    while not steps[-1].last():
        steps.append(env.step((1, 0)))
    assert len(steps) == 2 and steps[-1].discount == 0
    assert math.hypot(*(place(env) - goal)) <= env.motor.task.config.goal_radius
    assert env.step((1, 0)).first()


def test_the_time_limit_ends_the_episode_with_discount_1() -> None:
    env = loaded(time_limit=10.0)
    for _ in range(2):  # each episode has its own time
        env.reset(start=(2.0, 1.0))
        steps = [env.step((0, 0.3))]
        while not steps[-1].last():
            steps.append(env.step((0, 0.3)))
        durations = [float(step.observation["duration"]) for step in steps]
        assert sum(durations) >= 10 > sum(durations[:-1])
        assert steps[-1].discount == 1
    assert env.step((0, 0)).first()
    env.close()


@pytest.mark.parametrize("action", [(2, -3), (1e9, 0), (-5, 5)])
def test_actions_beyond_the_limits_count_as_at_them(
    env: PathFinding, action: tuple[float, float]
) -> None:
    places: list[list[float]] = []
    for made in (action, np.clip(action, -1, 1)):
        env.reset(seed=0, start=(5.0, 4.0))
        env.step(made)
        places.append(place(env).tolist())
    assert places[0] == places[1]


@pytest.mark.parametrize("action", [(np.nan, 0), (0, np.inf), (1, 0, 0), 0.5, ()])
def test_actions_that_are_none_are_refused_and_nothing_moves(env: PathFinding, action: Any) -> None:
    env.reset(seed=0, start=(5.0, 4.0))
    with pytest.raises(ValueError, match="must be two finite numbers"):
        env.step(action)
    assert place(env).tolist() == [5.0, 4.0]


@pytest.mark.parametrize(("robot", "decisions"), [("nomad200", 300), ("nomad200_wheels", 60)])
def test_random_decisions_never_end_at_a_bumper(robot: str, decisions: int) -> None:
    env = load(room="paper_room", robot=robot, task_kwargs={"random": 1})
    rng = np.random.default_rng(1)
    env.reset()
    told: list[Outcome] = []
    touched = 0.0
    for decision in range(decisions):
        step = env.reset() if decision % 30 == 0 else env.step(rng.uniform(-1, 1, 2))
        told.append(outcome(step))
        touched += step.observation["bumpers"].sum()
        assert step.observation["duration"] <= env.config.motion.longest
    assert Outcome.BUMPED not in told and not touched
    assert told.count(Outcome.VIRTUAL_COLLISION) > decisions / 60
    assert told.count(Outcome.MOVED) > decisions / 2
    env.close()


def test_a_moving_start_is_not_needed_both_drives_do_the_same() -> None:
    ends: list[FloatArray] = []
    for robot in ROBOTS:
        env = loaded("paper_room", robot)
        env.reset(seed=0, start=(5.0, 2.5, 0.5))
        for action in [(1, 0), (0.5, 0.8), (0.7, -0.7), (1, 0.1)]:
            env.step(action)
        ends.append(place(env))
        env.close()
    np.testing.assert_allclose(ends[0], ends[1], atol=0.03)
