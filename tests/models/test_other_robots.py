"""The files of the robots beside the Nomad 200: names, size, range sensors, bumpers."""

import mujoco
import numpy as np
import pytest
from other_robots import FACTS, MODELS, NUMBERS, RANGEFINDER, TOUCH, Robot


@pytest.fixture(params=FACTS)
def robot(request: pytest.FixtureRequest) -> Robot:
    return Robot(str(request.param))


def test_has_the_names_and_numbers_that_controllers_rely_on(robot: Robot) -> None:
    model, facts = robot.model, FACTS[robot.name]
    assert [model.actuator(i).name for i in range(model.nu)] == [
        f"robot/{name}" for name in facts.actuators
    ]
    assert (model.actuator_ctrlrange[: model.nu, 1] > 0).all()
    assert (model.actuator_forcerange[: model.nu, 1] > 0).all()
    assert model.body_subtreemass[model.body("robot/base").id] == pytest.approx(facts.mass)
    assert model.cam("robot/chase").bodyid[0] == model.body("robot/base").id
    assert all(robot.number(name) > 0 for name in NUMBERS)
    assert robot.number(f"{facts.ring}_min_range") < 0.3
    kinds, history = model.sensor_type, model.sensor_history[:, 0]
    assert (kinds == RANGEFINDER).sum() == facts.rays * len(facts.bearings)
    assert set(history[kinds == RANGEFINDER]) == {1}
    assert [model.sensor(int(i)).name for i in np.flatnonzero(kinds == TOUCH)] == [
        f"robot/bumper_{i}" for i in range(facts.bumpers)
    ]
    assert set(history[kinds == TOUCH]) <= {10}


def test_radius_holds_all_that_collides_and_no_tyre_reaches_a_wall(robot: Robot) -> None:
    furthest = 0.0
    for bearing in np.radians(np.arange(0, 360, 3)):
        reach = robot.reach(bearing)
        hull = max(r for name, r in reach.items() if "wheel" not in name and "castor" not in name)
        assert max(reach.values()) == hull
        furthest = max(furthest, hull)
    assert robot.number("radius") - 2e-3 < furthest < robot.number("radius") + 1e-6


def test_it_rests_where_it_is_put(robot: Robot) -> None:
    assert abs(robot.data.body("robot/base").xpos[2]) < 1e-4
    before = robot.pose()
    robot.drive([(0, 0)] * 200)
    np.testing.assert_allclose(robot.pose(), before, atol=1e-5)
    floor = robot.model.geom("floor").id
    assert all(floor in robot.data.contact[i].geom for i in range(robot.data.ncon))


def test_cones_look_where_they_should_and_read_a_wall_where_it_is(robot: Robot) -> None:
    facts, model, data = FACTS[robot.name], robot.model, robot.data
    sensors = np.flatnonzero(model.sensor_type == RANGEFINDER)
    seen: dict[int, list[float]] = {}
    for sensor in sensors:
        site = model.sensor_objid[sensor]
        cone = int(model.sensor(int(sensor)).name.rpartition("_")[2])
        assert model.sensor(int(sensor)).name.startswith(f"robot/{facts.ring}_")
        assert model.site_bodyid[site] == model.body("robot/base").id
        axis = data.site_xmat[site].reshape(3, 3)[:, 2]
        bearing = float(np.arctan2(axis[1], axis[0]))
        assert abs(axis[2]) < 2e-3
        seen.setdefault(cone, []).append(np.degrees(bearing))
        mujoco.mj_resetData(model, data)
        robot.put_wall(1.2, bearing)
        start = data.site_xpos[site]
        expected = 1.2 - start[0] * np.cos(bearing) - start[1] * np.sin(bearing)
        assert data.sensordata[model.sensor_adr[sensor]] == pytest.approx(expected, abs=1e-5)
    for cone, bearing in enumerate(facts.bearings):
        offsets = (np.array(seen[cone]) - bearing + 180) % 360 - 180
        wanted = np.linspace(-facts.spread / 2, facts.spread / 2, facts.rays)
        np.testing.assert_allclose(offsets, wanted, atol=0.1)


def test_no_ray_meets_the_robot_itself(robot: Robot) -> None:
    rays = robot.model.sensor_type == RANGEFINDER
    reach = robot.model.sensor_cutoff[rays]
    for command in ((0.3, 0.0), (0.3, 0.4), (0.0, -0.4)):
        robot.drive([command] * 15)
        seen = robot.data.sensordata[robot.model.sensor_adr[rays]]
        assert ((seen < 0) | (seen == reach)).all()  # a nod sees the floor beyond the range


def test_bumpers_feel_every_push_that_they_guard_against(robot: Robot) -> None:
    facts, felt = FACTS[robot.name], set[int]()
    for direction in range(0, 360, 3):
        bearing = np.radians(direction)
        for depth in (1e-5, 5e-3):
            robot.put_wall(max(robot.reach(bearing).values()) - depth, bearing)
            touched = robot.touched()
            felt.update(touched)
            from_an_end = min(abs((direction + 180) % 360 - 180), abs(direction - 180))
            assert touched or from_an_end > facts.guarded or not facts.bumpers
    assert felt == set(range(facts.bumpers))


def test_a_light_touch_is_still_known_at_the_end_of_the_control_step(robot: Robot) -> None:
    if not FACTS[robot.name].bumpers:
        pytest.skip("has no bumper")
    robot.put_wall(max(robot.reach(0).values()) - 1e-4, 0)
    mujoco.mj_step(robot.model, robot.data)
    (number,) = robot.touched()[:1]
    robot.put_wall(5, 0)
    mujoco.mj_step(robot.model, robot.data, 9)
    assert not robot.touched()
    sensor = robot.model.sensor(f"robot/bumper_{number}").id
    values = robot.model.sensor_historyadr[sensor] + 12
    assert robot.data.history[values : values + 10].max() > 0


def test_a_file_opens_and_steps_on_its_own(robot: Robot) -> None:
    file = MODELS / "robots" / robot.name / f"{robot.name}.xml"
    data = mujoco.MjData(model := mujoco.MjModel.from_xml_path(str(file)))
    data.ctrl[:] = 0.3
    mujoco.mj_step(model, data, 200)
    assert data.warning.number.sum() == 0
