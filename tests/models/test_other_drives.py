"""How the robots beside the Nomad 200 drive: straight, round, and into walls."""

import mujoco
import numpy as np
import pytest
from other_robots import CONTROL_STEP, FACTS, OMNI, TURNERS, Robot

from nomad_mj.types import FloatArray


@pytest.fixture(params=FACTS)
def robot(request: pytest.FixtureRequest) -> Robot:
    return Robot(str(request.param))


@pytest.mark.parametrize("sign", [1, -1])
def test_a_wall_stops_it(robot: Robot, sign: int) -> None:
    reach = max(robot.reach(0 if sign > 0 else np.pi).values())
    robot.put_wall(1.2, 0 if sign > 0 else np.pi)
    speed = robot.number("translate_max_speed")
    rise = speed / robot.number("translate_max_acceleration") / CONTROL_STEP
    inside = [0.0]
    for step in range(120):
        robot.drive([(sign * speed * min(1, step / rise), 0)])
        inside.append(sign * robot.pose()[0] + reach - 1.2)
    assert max(inside) < 0.02 and abs(inside[-1]) < 5e-4
    assert abs(robot.data.body("robot/base").xmat[8] - 1) < 1e-4  # it does not climb
    assert bool(robot.touched()) == bool(FACTS[robot.name].bumpers)


def test_two_metres_are_two_metres(robot: Robot) -> None:
    robot.go(distance=2)
    np.testing.assert_allclose(robot.pose(), [2, 0, 0], atol=3e-3)


@pytest.mark.parametrize("name", TURNERS)
def test_a_square_and_a_turn_are_where_the_wheels_say(name: str) -> None:
    robot = Robot(name)
    metres, degrees = FACTS[name].tolerance
    robot.go(angle=2 * np.pi)
    assert robot.error()[0] < metres and robot.error()[1] < degrees
    start, robot.reckoned = robot.pose(), robot.pose()
    for _ in range(4):
        robot.go(distance=2)
        robot.go(angle=np.pi / 2)
        assert robot.error()[0] < metres and robot.error()[1] < degrees
    np.testing.assert_allclose(robot.pose()[:2], start[:2], atol=5e-3)


@pytest.mark.parametrize("name", TURNERS)
def test_an_arc_is_where_the_wheels_say(name: str) -> None:
    robot = Robot(name)
    ramp = [min(k + 1, 160 - k, 30) / 30 for k in range(160)]
    robot.drive([(0.5 * r, 0.7 * r) for r in ramp])
    metres, degrees = robot.error()
    assert metres < 5e-3 and degrees < 0.1


def test_the_omnibot_drives_sideways_and_keeps_its_heading() -> None:
    for way in ([0, 0.5, 0], [-0.3, 0.2, 0]):
        robot = Robot("omnibot")
        for share in [*np.linspace(0, 1, 40), *[1.0] * 10]:
            robot.data.ctrl[:] = OMNI @ way * share
            mujoco.mj_step(robot.model, robot.data, 5)
        np.testing.assert_allclose(robot.data.qvel, way, atol=1e-3)
        assert abs(robot.pose()[2]) < 1e-6


@pytest.mark.parametrize("angle", [0.45, 0.2, -0.45])
def test_the_racer_turns_in_the_circle_of_a_bicycle(angle: float) -> None:
    robot = Robot("racer")
    base = robot.number("wheelbase")
    robot.drive([(min(1, k / 14), angle) for k in range(30)])
    places: list[FloatArray] = []
    for _ in range(120):
        robot.drive([(1.0, angle)])
        places.append(robot.pose())
    path = np.array(places)
    rear = base / np.tan(angle)
    distances = np.hypot(*(path[1:, :2] - path[:-1, :2]).T)
    turns = np.angle(np.exp(1j * np.diff(path[:, 2])))
    radii = distances / (2 * np.sin(np.abs(turns) / 2))
    np.testing.assert_allclose(radii, np.hypot(rear, base / 2), rtol=1.5e-3)
    np.testing.assert_allclose(turns / CONTROL_STEP, 1 / rear, rtol=2.5e-3)
    left, right = (robot.data.joint(f"robot/wheel_{side}").qpos[0] for side in ("left", "right"))
    assert 1 / np.tan(right) - 1 / np.tan(left) == pytest.approx(0.254 / base, rel=0.02)


def test_servos_follow_the_greatest_acceleration(robot: Robot) -> None:
    speed = robot.number("translate_max_speed")
    rise = round(speed / robot.number("translate_max_acceleration") / CONTROL_STEP)
    for step in range(1, rise + 1):
        wanted = speed * step / rise
        robot.drive([(wanted, 0.0)])
        assert abs(robot.data.qvel[0] - wanted) < 0.04 * speed  # along x: it drives straight


def test_random_driving_raises_no_warning(robot: Robot) -> None:
    rng = np.random.default_rng(1)
    top = robot.model.actuator_ctrlrange[: robot.model.nu, 1]
    robot.put_wall(0.6, 0)
    for _ in range(300):
        robot.data.ctrl[:] = rng.uniform(-top, top)
        mujoco.mj_step(robot.model, robot.data, 10)
    assert robot.data.warning.number.sum() == 0
    assert robot.data.body("robot/base").xmat[8] > 0.995  # upright
