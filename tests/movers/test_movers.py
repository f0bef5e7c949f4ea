"""Moving goals and obstacles in the simulation: what is told, felt, drawn, and what they keep."""

import math
import pickle
from collections.abc import Iterator
from itertools import chain
from typing import Any

import mujoco
import numpy as np
import pytest
import shapely

from nomad_mj import (
    MotorEnvironment,
    MovingGoal,
    MovingObstacles,
    PathFinding,
    RangeNoise,
    list_robots,
    load,
)
from nomad_mj.errors import ConfigError, NomadError, StartError
from nomad_mj.movers import Movers
from nomad_mj.movers.movers import GAP, ROBOT_GAP, START_GAP
from nomad_mj.types import FloatArray

RADIUS = 0.265
FAST: dict[str, Any] = {
    "moving_goal": MovingGoal(speed=1.0),
    "moving_obstacles": MovingObstacles(speed=1.0),
}


def motor(room: str = "paper_room", goal: Any = None, **options: Any) -> MotorEnvironment:
    options = {"random": 0, "ends_at_goal": False} | options
    return load("motor", room=room, task_kwargs=options, goal=goal)


@pytest.fixture(scope="module")
def env() -> Iterator[MotorEnvironment]:
    made = motor(**FAST, range_noise=RangeNoise("none"))
    yield made
    made.close()


def movers_of(env: MotorEnvironment) -> Movers:
    assert env.task.movers is not None
    return env.task.movers


def drawn_goal(env: MotorEnvironment | PathFinding) -> FloatArray:
    return env.physics.named.data.site_xpos["room/goal"][:2]


def drawn_obstacles(env: MotorEnvironment) -> FloatArray:
    named = env.physics.named.data.xpos
    return np.array([named[f"room/{body.name}"][:2] for body in env.task.scene.moving.obstacles])


def about(env: MotorEnvironment, steps: int, seed: int = 0) -> Iterator[Any]:
    """Drive about at random and yield each time step."""
    rng = np.random.default_rng(seed)
    action = np.zeros(3)
    for tick in range(steps):
        if tick % 20 == 0:
            action = rng.uniform([-0.3, -1, -1], [0.6, 1, 1])
        yield env.step(action)


def test_the_goal_told_and_drawn_and_the_one_that_counts_are_one(env: MotorEnvironment) -> None:
    first = env.reset(seed=1, start=0)
    moved = 0.0
    for step in chain([first], about(env, 150)):
        told = step.observation
        goal = env.task.goal
        np.testing.assert_allclose(told["goal"] + told["odometry"][:2], goal, atol=1e-12)
        np.testing.assert_allclose(drawn_goal(env), goal, atol=1e-12)
        pose = env.physics.pose()
        assert env.task.goal_distance(env.physics) == math.dist(pose[:2], goal)
        np.testing.assert_allclose(drawn_obstacles(env), movers_of(env).obstacles, atol=1e-12)
        moved = max(moved, math.dist(goal, env.task.scene.arena.goal))
    assert moved > 1


def test_a_goal_that_comes_to_the_robot_ends_the_episode_of_the_motor_task() -> None:
    env = motor(moving_goal=MovingGoal(speed=1.0, spread=0.0), ends_at_goal=True)
    x, y = env.task.scene.arena.goal
    step = env.reset(start=(x - 1.5, y))
    for _ in range(300):
        step = env.step(np.zeros(3))
        assert step.last() == (math.dist(env.task.goal, (x - 1.5, y)) <= 0.2)
        if step.last():
            break
    assert step.last() and step.discount == 0 and step.reward == 1
    env.close()


def test_a_move_of_path_finding_ends_at_the_goal_as_it_then_is() -> None:
    env = load(room="empty_room", task_kwargs={"random": 0, "moving_goal": MovingGoal()})
    ends = 0
    for start in range(4):
        step = env.reset(start=start)
        for _ in range(25):
            step = env.step((1.0, 0.0))
            told, pose = step.observation, env.physics.pose()
            goal = told["goal"] + told["odometry"][:2]
            np.testing.assert_allclose(goal, env.motor.task.goal, atol=1e-9)
            np.testing.assert_allclose(drawn_goal(env), env.motor.task.goal, atol=1e-12)
            near = math.dist(pose[:2], env.motor.task.goal) <= 0.2
            assert near == (step.last() and step.discount == 0)
            if step.last():
                ends += near
                break
    assert ends
    env.close()


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


@pytest.mark.parametrize("robot", list_robots())
def test_the_robot_can_bump_into_an_obstacle_which_is_not_moved_by_it(robot: str) -> None:
    still = MovingObstacles(count=1, speed=1e-9)
    env = load("motor", "empty_room", robot, {"moving_obstacles": still, "ends_at_goal": False})
    env.reset(seed=0, start=(5.0, 5.0))
    (place,) = drawn_obstacles(env)
    heading = math.atan2(place[1] - 5, place[0] - 5)
    step = env.reset(seed=0, start=(5.0, 5.0, heading))
    ours = env.task.scene.robot
    gap = math.dist(place, (5, 5)) - 0.25 - ours.layout.radius
    ahead = ours.drive.twist(0.3, 0.0, 0.0, env.task.travel)
    for _ in range(int(gap / 0.3 / 0.05) + 60):
        step = env.step(ahead)
    assert step.observation["bumpers"].any() or not ours.bumpers
    np.testing.assert_allclose(drawn_obstacles(env)[0], place, atol=1e-6)
    reached = math.dist(env.physics.pose()[:2], (5, 5))
    inside = 0.07 if robot == "pioneer" else 0.02  # it is shorter ahead of its axle than behind
    assert gap - 0.02 < reached < gap + inside + 0.02
    env.close()


def test_rays_see_the_obstacles_where_they_are_at_that_instant(env: MotorEnvironment) -> None:
    """Every ray against the circles: to a millimetre, at the end of each control step."""
    scene = env.task.scene
    model, rays = scene.model, scene.robot.rays
    sites = {int(model.sensor_adr[s]): int(model.sensor_objid[s]) for s in range(model.nsensor)}
    at = [sites[int(address)] for address in rays.address]
    movers = movers_of(env)
    seen = 0
    for seed in range(4):
        env.reset(seed=seed)
        for tick in range(60):
            if tick:
                env.step((0.2, 0.3, 0.4))
            data = env.physics.data
            hits = _to_circles(
                data.site_xpos[at][:, :2], data.site_xmat[at][:, 2::3], movers.obstacles, 0.25
            )
            read = data.sensordata[rays.address]
            walls = ~np.isfinite(hits)
            nearer = (read > 0) & (read < hits - 1e-3)  # something stands before it
            good = np.abs(read - hits, where=~walls, out=np.full_like(hits, np.inf)) < 1e-3
            far = hits > model.sensor_cutoff[0]
            assert (walls | nearer | good | far | (hits > 6)).all()
            seen += int(good.sum())
    assert seen > 200


def _to_circles(
    start: FloatArray, axis: FloatArray, centres: FloatArray, radius: float
) -> FloatArray:
    """Return how far along each ray (R,) the first upright cylinder is, inf if none."""
    flat = np.hypot(axis[:, 0], axis[:, 1])
    toward = axis[:, :2] / flat[:, None]
    offset = centres - start[:, None]
    along = np.einsum("rnk,rk->rn", offset, toward)
    across = np.einsum("rnk,rnk->rn", offset, offset) - along**2
    depth = np.sqrt(np.where(across < (radius - 1e-3) ** 2, radius**2 - across, np.nan))
    met = np.where(np.isfinite(depth) & (along > 0), along - depth, np.inf)
    return met.min(axis=1) / flat


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


def test_nothing_else_changes_where_movers_are_far(env: MotorEnvironment) -> None:
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


def test_another_goal_is_told_and_drawn_and_starts_are_checked_against_it() -> None:
    both: list[dict[str, Any]] = [{}, {"moving_goal": MovingGoal()}]
    for options in both:
        env = motor(goal=(2.4, 4.2), **options)
        step = env.reset(start=0)
        np.testing.assert_allclose(env.task.scene.arena.goal, (2.4, 4.2))
        np.testing.assert_allclose(
            step.observation["goal"], np.array([2.4, 4.2]) - [5, 10 / 3], atol=1e-3
        )
        np.testing.assert_allclose(drawn_goal(env), (2.4, 4.2))
        here, plain = env.task.scene.model, motor().task.scene.model
        for what in ("site_size", "site_rgba", "site_type", "site_matid", "site_group"):
            index = [
                mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_SITE, "room/goal") for m in (here, plain)
            ]
            looks = [getattr(m, what)[i] for m, i in zip((here, plain), index, strict=True)]
            np.testing.assert_array_equal(*looks)
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
