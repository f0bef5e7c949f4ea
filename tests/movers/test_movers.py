"""Moving goals and obstacles in the simulation: what they keep, and what cannot be."""

import math
import pickle
from typing import Any

import numpy as np
import pytest
import shapely
from known_movers import FAST, RADIUS, about, motor, movers_of

from nomad_mj import MotorEnvironment, MovingGoal, MovingObstacles, OdometryNoise
from nomad_mj.errors import ConfigError, NomadError, StartError
from nomad_mj.movers.movers import GAP, ROBOT_GAP, START_GAP


@pytest.mark.parametrize("room", ["paper_room", "clutter", "corridor"])
def test_movers_keep_their_rules(room: str) -> None:
    env = motor(room, **FAST)
    plan, free = env.task.scene.plan, env.task.scene.free_space
    movers = movers_of(env)
    apart = movers.radii[:, None] + movers.radii + GAP - np.diag([np.inf] * 4) - 1e-9
    for seed in range(3):
        env.reset(seed=seed)
        robot = np.array(env.physics.pose()[:2])
        off = np.hypot(*(movers.obstacles - robot).T) - movers.radii - RADIUS
        assert (off >= START_GAP).all()
        for _ in about(env, 200, seed):
            places, goal = movers.obstacles, movers.goal
            assert (plan.clearance(places, 0.25) > 0.6 * GAP).all()
            assert (np.linalg.norm(places[:, None] - places, axis=-1) >= apart).all()
            assert (np.hypot(*(places - goal).T) >= 0.25 + RADIUS + ROBOT_GAP - 1e-9).all()
            assert plan.clearance(goal, RADIUS) > 0.1
            assert shapely.contains_xy(free, *goal)
    env.close()


def test_obstacles_never_come_near_the_robot_of_themselves() -> None:
    env = motor("empty_room", moving_obstacles=CROWD)
    movers = movers_of(env)
    nearest = math.inf
    for seed in range(3):
        env.reset(seed=seed, start=(5.0, 5.0))
        for _ in range(300):
            env.step(np.zeros(3))
            robot = env.physics.pose()
            gaps = np.hypot(*(movers.obstacles - robot[:2]).T) - 0.25 - RADIUS
            nearest = min(nearest, gaps.min())
            assert gaps.min() >= ROBOT_GAP - 1e-6
            assert math.dist(robot[:2], (5, 5)) < 1e-6 and not env.physics.bumpers().any()
    assert nearest < ROBOT_GAP + 0.05  # and some came as near as they may
    env.close()


CROWD = MovingObstacles(count=16, speed=1.0)


def digest(env: MotorEnvironment, seed: int | None, steps: int = 60) -> bytes:
    told: list[Any] = [
        env.reset(seed=seed).observation,
        *(step.observation for step in about(env, steps)),
    ]
    places = [env.task.goal, movers_of(env).obstacles]
    return b"".join(np.asarray(v).tobytes() for o in told for v in o.values()) + b"".join(
        place.tobytes() for place in places
    )


def test_the_same_seed_gives_the_same_bits_and_a_reset_leaves_no_trace() -> None:
    env, other = motor(**FAST), motor(**FAST)
    wanted = digest(env, 5)
    second = digest(env, None)
    digest(other, 8, 25)
    assert digest(other, 5) == wanted
    assert digest(other, None) == second != wanted
    env.close()
    other.close()


def test_obstacles_start_clear_of_where_the_goal_is_not_of_where_it_was() -> None:
    options = {
        "moving_goal": MovingGoal(speed=1.0, spread=0.0, period=100.0),
        "moving_obstacles": MovingObstacles(count=3),
    }
    fresh, driven = motor("empty_room", **options), motor("empty_room", **options)
    for seed in range(40):
        fresh.reset(seed=seed)
        driven.reset(seed=seed)
        np.testing.assert_array_equal(movers_of(fresh).obstacles, movers_of(driven).obstacles)
        list(about(driven, 20))
        assert not np.array_equal(movers_of(driven).goal, movers_of(fresh).goal)
    fresh.close()
    driven.close()


def test_a_start_that_cannot_be_is_asked_for_once(monkeypatch: pytest.MonkeyPatch) -> None:
    env = motor("empty_room", moving_obstacles=MovingObstacles(count=2))
    start = movers_of(env).start

    def fails(*_: Any) -> None:
        raise StartError("no place")

    monkeypatch.setattr(movers_of(env), "start", fails)
    with pytest.raises(StartError):
        env.reset(seed=0, start=(5.0, 5.0, 1.0))
    monkeypatch.setattr(movers_of(env), "start", start)
    env.reset(seed=0)
    assert env.physics.pose() != (5.0, 5.0, 1.0)
    env.close()


def test_obstacles_draw_from_a_stream_of_their_own() -> None:
    noise = {"odometry_noise": OdometryNoise(0.05, 0.05, 0.1)}
    plain = motor("empty_room", **noise)
    moving = motor("empty_room", moving_obstacles=MovingObstacles(count=2), **noise)
    for _ in range(4):
        steps = [env.reset() for env in (plain, moving)]
        steps += [env.step((0.2, 0.1, 0.3)) for env in (plain, moving)]
        told = [step.observation["odometry"] for step in steps]
        np.testing.assert_array_equal(told[0], told[1])
        np.testing.assert_array_equal(told[2], told[3])
    plain.close()
    moving.close()


def test_nothing_else_changes_where_movers_are_far() -> None:
    """The other streams of an episode are what they are without movers."""
    plain = motor()
    moving = motor(moving_goal=MovingGoal())
    for _ in range(2):
        first, second = plain.reset(), moving.reset()
        for name in ("sonar", "infrared", "odometry", "goal"):
            np.testing.assert_array_equal(first.observation[name], second.observation[name])
        sonars = [made.step((0.2, 0.1, 0.3)).observation["sonar"] for made in (plain, moving)]
        np.testing.assert_array_equal(*sonars)
    plain.close()
    moving.close()


@pytest.mark.parametrize("way", ["copy", "pickle"])
def test_a_copy_of_the_simulation_has_the_movers_where_they_are(
    env: MotorEnvironment, way: str
) -> None:
    env.reset(seed=2)
    list(about(env, 30))
    made = env.physics.copy() if way == "copy" else pickle.loads(pickle.dumps(env.physics))
    np.testing.assert_array_equal(made.data.mocap_pos, env.physics.data.mocap_pos)
    for physics in (made, env.physics):
        physics.step(10)
    np.testing.assert_array_equal(made.cone_ranges(), env.physics.cone_ranges())
    made.move_bodies(np.array([0]), np.array([[1.0, 1.0]]))
    assert (made.data.mocap_pos != env.physics.data.mocap_pos).any()
    made.free()


def test_without_movers_there_are_none() -> None:
    env = motor()
    assert env.task.movers is None and not env.task.scene.moving
    env.task.goal[:] = 0  # a copy
    np.testing.assert_array_equal(env.task.goal, env.task.scene.arena.goal)
    env.close()


REFUSED: list[tuple[dict[str, Any], type[NomadError], str]] = [
    ({"goal": (4.8, 5.0)}, StartError, "at site 'goal' (4.80, 5.00) overlaps 'obstacle_middle'"),
    ({"goal": (40, 50)}, StartError, "cannot reach the goal (40.00, 50.00) from site 'start_00'"),
    ({"goal": (1, 2, 3)}, ConfigError, "goal (1, 2, 3): must be (x, y) in metres"),
    ({"goal": "there"}, ConfigError, "goal there: must be (x, y) in metres"),
    ({"goal": (math.nan, 2)}, ConfigError, "goal (nan, 2): must be (x, y) in metres"),
    ({"goal": True}, ConfigError, "goal True: must be (x, y) in metres"),
    ({"moving_goal": True}, ConfigError, "moving_goal True: must be a MovingGoal, such as "),
    ({"moving_obstacles": 4}, ConfigError, "moving_obstacles 4: must be a MovingObstacles, such"),
    ({"moving_obstacles": False}, ConfigError, "moving_obstacles False: must be a MovingObst"),
    (
        {"moving_obstacles": MovingObstacles(count=400)},
        StartError,
        "of radius 0.25 m, 0.5 m from the robot and clear of everything; take fewer",
    ),
    ({"moving_obstacles": MovingObstacles(radius=6)}, StartError, "moving obstacle 'moving_0'"),
]


@pytest.mark.parametrize(("options", "error", "message"), REFUSED)
def test_what_cannot_be_is_refused_in_one_line(
    options: dict[str, Any], error: type[NomadError], message: str
) -> None:
    with pytest.raises(error) as caught:
        motor(**options)
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_no_obstacles_are_no_movers() -> None:
    env = motor(moving_obstacles=MovingObstacles(count=0))
    assert env.task.movers is None
    env.close()
