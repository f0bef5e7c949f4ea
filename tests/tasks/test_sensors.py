"""What the robot senses, against the geometry of the room and the engine's own truth."""

import math
from collections.abc import Iterator

import numpy as np
import pytest

from nomad_mj import MotorEnvironment, RangeNoise, load
from nomad_mj.tasks import NavigationPhysics
from nomad_mj.types import FloatArray, Pose

ROBOTS = ("nomad200", "nomad200_wheels")
QUIET = {"range_noise": RangeNoise("none")}
RADIUS = 0.265
CONES = 16


@pytest.fixture(scope="module", params=ROBOTS)
def env(request: pytest.FixtureRequest) -> Iterator[MotorEnvironment]:
    """A robot without noise in a room of four walls, 10 x 10 m."""
    made = load("motor", "empty_room", request.param, task_kwargs=QUIET)
    yield made
    made.close()


def walls_seen(physics: NavigationPhysics, ring: str) -> FloatArray:
    """Return how far each cone sees from the perimeter [m], by the geometry of its rays."""
    seen: list[float] = []
    centre = physics.named.data.xpos["robot/turret"][:2]
    for cone in range(CONES):
        nearest, outside = math.inf, 0.0
        for ray in range(5 if ring == "sonar" else 3):
            site = physics.named.data.site_xpos[f"robot/{ring}_{ray}_{cone:02d}"]
            along = physics.named.data.site_xmat[f"robot/{ring}_{ray}_{cone:02d}"][[2, 5]]
            outside = RADIUS - math.hypot(*(site[:2] - centre))
            for start, direction in zip(site[:2].tolist(), along.tolist(), strict=True):
                if abs(direction) > 1e-12:
                    wall = 10.0 if direction > 0 else 0.0
                    nearest = min(nearest, (wall - start) / direction)
        least, most = (0.15, 6.5) if ring == "sonar" else (0.0, 0.6)
        seen.append(most if nearest >= most else max(nearest - outside, least))
    return np.array(seen)


@pytest.mark.parametrize("start", [(1.0, 1.2), (0.6, 5.0), (9.5, 9.4), (5.0, 5.0), (8.9, 3.3)])
def test_walls_are_read_where_they_are_at_every_bearing_while_driving(
    env: MotorEnvironment, start: tuple[float, float]
) -> None:
    rng = np.random.default_rng(1)
    step = env.reset(seed=0, start=(*start, 0.4))
    for _ in range(15):
        for ring in ("sonar", "infrared"):
            wanted = walls_seen(env.physics, ring)
            np.testing.assert_allclose(step.observation[ring], wanted, atol=1e-9)
        step = env.step(rng.uniform(-1, 1, 3) * [0.3, 1.0, 1.5])


@pytest.mark.parametrize("away", [0.02, 0.1, 0.149, 0.151, 0.4, 0.56, 0.57, 0.9, 3.0])
def test_a_wall_straight_ahead_reads_its_distance_from_the_perimeter(
    env: MotorEnvironment, away: float
) -> None:
    for cone, start in (
        (0, (10 - RADIUS - away, 5.0)),
        (4, (5.0, 10 - RADIUS - away)),
        (8, (RADIUS + away, 5.0)),
        (12, (5.0, RADIUS + away)),
    ):
        seen = env.reset(start=start).observation
        assert seen["sonar"][cone] == pytest.approx(max(away, 0.15), abs=1e-9)
        # The sensor sits behind the perimeter, from where it sees as far as its cut-off.
        near = away + RADIUS - 0.23 < 0.6
        assert seen["infrared"][cone] == pytest.approx(away if near else 0.6, abs=1e-9)


def test_a_miss_reads_the_maximum_range_with_noise_too() -> None:
    env = load("motor", "empty_room")
    for _ in range(50):
        seen = env.reset(start=(5.0, 5.0)).observation
        assert (seen["infrared"] == 0.6).all()
        assert (seen["sonar"] < 6.5).all()
    env.close()


def test_noise_multiplies_the_distance_and_keeps_within_the_limits() -> None:
    start = (0.7, 0.75)
    quiet, noisy = (load("motor", "empty_room", task_kwargs=kw) for kw in (QUIET, {}))
    truth = quiet.reset(start=start).observation
    readings = [noisy.reset(start=start).observation for _ in range(300)]
    for ring, least, most in (("sonar", 0.15, 6.5), ("infrared", 0.0, 0.6)):
        seen = np.array([reading[ring] for reading in readings])
        assert seen.min() >= least and seen.max() <= most
        free = (truth[ring] < most / 1.15) & (truth[ring] > least / 0.85)
        share = seen[:, free] / truth[ring][free] - 1
        assert share.size and np.abs(share).max() <= 0.15 + 1e-9
        np.testing.assert_allclose(share.mean(axis=0), 0, atol=0.02)
        np.testing.assert_allclose(share.std(axis=0), 0.15 / math.sqrt(3), rtol=0.15)
    quiet.close()
    noisy.close()


def test_bumpers_tell_of_every_touch_since_the_last_control_step(env: MotorEnvironment) -> None:
    """Step for step against the touch sensors read at every physics step."""
    env.reset(seed=0, start=(9.6, 5.0, 0.0))
    truth = env.physics.copy()
    touched = list[FloatArray]()
    speeds = [0.3] * 12 + [-0.3] * 3 + [0.3] * 8 + [-0.05, 0.25] * 20 + [-0.5] * 20
    for speed in speeds:
        felt = np.zeros(20)
        truth.data.ctrl[:3] = speed, 0.3, 0.5
        for _ in range(10):
            truth.step()
            forces = [truth.named.data.sensordata[f"robot/bumper_{i}"][0] for i in range(20)]
            felt = np.maximum(felt, np.array(forces) > 0)
        seen = env.step((speed, 0.3, 0.5)).observation["bumpers"]
        np.testing.assert_array_equal(seen, felt)
        touched.append(felt)
    assert set(np.flatnonzero(np.any(touched, axis=0))) <= {18, 19, 0, 1, 2}
    flags = np.any(touched, axis=1)
    assert 5 < flags.sum() < len(flags) - 10 and not flags[-10:].any()
    truth.free()


def test_a_touch_gone_by_the_end_of_the_control_step_is_still_told() -> None:
    env = load("motor", "empty_room")
    physics, at_end, within = env.physics, 0, 0
    for offset in np.linspace(0, 0.01, 30):
        env.reset(start=(10 - RADIUS - 0.02 - float(offset), 5.0, 0.0))
        speed = physics.named.data.qvel
        speed["robot/base_x"] = 0.5  # comes in at speed, is thrown back and brakes
        for _ in range(3):
            seen = env.step((-0.61, 0, 0)).observation["bumpers"].any()
            now = any(physics.named.data.sensordata[f"robot/bumper_{i}"][0] for i in range(20))
            at_end += now
            within += bool(seen)
            assert seen >= now
    assert within > at_end
    env.close()


def test_encoders_add_up_to_the_way_driven(env: MotorEnvironment) -> None:
    step = env.reset(seed=0, start=(2.0, 3.0, 0.5))
    before, driven, tolerance = env.physics.pose(), 0.0, 1e-6
    if env.task.scene.robot.name == "nomad200_wheels":
        tolerance = 2e-3
    for tick in range(100):
        step = env.step((0.6 * math.sin(tick / 12), 0.0, 0.2))
        driven += step.observation["encoders"][0]
        x, y, _ = env.physics.pose()
        along = (x - before.x) * math.cos(0.5) + (y - before.y) * math.sin(0.5)
        assert driven == pytest.approx(along, abs=tolerance)
        assert step.observation["encoders"][1] == pytest.approx(0.5, abs=2e-3)
    turret = env.physics.named.data.qpos["robot/turret"][0]
    assert step.observation["encoders"][2] == pytest.approx(turret, abs=1e-12)
    assert turret == pytest.approx(100 * 0.05 * 0.2, abs=0.05)


def test_without_noise_the_robot_knows_where_it_is(env: MotorEnvironment) -> None:
    rng = np.random.default_rng(3)
    step = env.reset(seed=0, start=(5.0, 4.0, -2.0))
    np.testing.assert_allclose(step.observation["odometry"], [5, 4, -2, 0], atol=1e-12)
    goal, action, worst = env.task.scene.arena.goal, np.zeros(3), 0.0
    for tick in range(200):
        if tick % 20 == 0:
            action = rng.uniform(-1, 1, 3) * [0.3, 0.5, 1.0]
        step = env.step(action)
        x, y, heading, turret = step.observation["odometry"]
        worst = max(worst, math.hypot(*(np.array([x, y]) - env.physics.pose()[:2])))
        assert heading == pytest.approx(env.physics.pose().heading, abs=1e-9)
        assert turret == pytest.approx(env.physics.named.data.qpos["robot/turret"][0], abs=1e-9)
        np.testing.assert_allclose(step.observation["goal"], goal - [x, y], atol=1e-12)
    assert worst < 0.004
    assert not step.observation["bumpers"].any()


def test_place_puts_the_robot_where_it_is_told_and_it_stays(env: MotorEnvironment) -> None:
    for pose in (Pose(3.0, 4.0, 2.5), Pose(6.0, 1.0, -7.0)):
        env.reset(start=tuple(pose))
        np.testing.assert_allclose(env.physics.pose(), pose, atol=1e-12)
        for _ in range(10):
            step = env.step((0.0, 0.0, 0.0))
            np.testing.assert_allclose(env.physics.pose(), pose, atol=1e-6)
            np.testing.assert_allclose(step.observation["odometry"][:3], pose, atol=1e-6)
