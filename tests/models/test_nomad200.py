"""The Nomad 200's two MJCF files, alone and in the scene, by mujoco alone."""

from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pytest

from nomad_mj.types import FloatArray

MODELS = Path(__file__).resolve().parents[2] / "models"
ROBOTS = ("nomad200", "nomad200_wheels")
RADIUS, SITE_RADIUS, CONTROL_STEP = 0.265, 0.23, 0.05
# Rays of a cone, their spacing [deg], range [m], height [m].
RINGS = {"sonar": (5, 7.5, 6.5, 0.688), "infrared": (3, 15.0, 0.6, 0.41)}
BEARINGS = np.arange(16) * 22.5
LIMITS = {"translate": 0.61, "steer": np.radians(60), "turret": np.radians(90)}
RANGEFINDER = mujoco.mjtSensor.mjSENS_RANGEFINDER


@cache
def in_scene(robot: str, obstacle: str = "") -> mujoco.MjModel:
    """Return the robot on the scene's floor, with a movable wall or pole if asked."""
    spec = mujoco.MjSpec.from_file(str(MODELS / "scene.xml"))
    spec.compiler.conflict = mujoco.mjtConflict.mjCONFLICT_ERROR
    if obstacle:
        body = spec.worldbody.add_body(name="obstacle", mocap=True, pos=[50, 0, 0.5])
        box = obstacle == "wall"
        shape = mujoco.mjtGeom.mjGEOM_BOX if box else mujoco.mjtGeom.mjGEOM_CYLINDER
        body.add_geom(type=shape, size=[0.1, 2, 0.5] if box else [0.1, 0.5, 0])
    child = mujoco.MjSpec.from_file(str(MODELS / "robots" / "nomad200" / f"{robot}.xml"))
    spec.attach(child, prefix="robot/", frame=spec.worldbody.add_frame())
    model = spec.compile()
    model.sensor_interval[model.sensor_type == RANGEFINDER, 0] = CONTROL_STEP - 1e-9
    return model


class Nomad:
    """A simulated robot, driven the way a controller drives it."""

    def __init__(self, robot: str, obstacle: str = "") -> None:
        self.model = in_scene(robot, obstacle)
        self.data = mujoco.MjData(self.model)
        joints = [f"robot/{name}" for name in ("base_x", "base_y", "steer", "turret")]
        self.joints = np.array([self.model.joint(name).qposadr[0] for name in joints])
        self.driven = 0.0
        mujoco.mj_forward(self.model, self.data)

    def read(self, name: str) -> float:
        return float(self.data.sensor(f"robot/{name}").data[0])

    def bumpers(self) -> FloatArray:
        return np.array([self.read(f"bumper_{i}") for i in range(20)])

    def move_obstacle(self, distance: float, bearing: float) -> None:
        """Put the obstacle's middle `distance` [m] from the base, at `bearing` [deg]."""
        angle = np.radians(bearing)
        self.data.mocap_pos[0] = [distance * np.cos(angle), distance * np.sin(angle), 0.5]
        self.data.mocap_quat[0] = [np.cos(angle / 2), 0, 0, np.sin(angle / 2)]
        mujoco.mj_forward(self.model, self.data)

    def place(self, x: float, y: float, heading: float, turret: float = 0) -> None:
        """Reset to a pose, and take the first sample of every sensor there."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[self.joints] = x, y, heading, turret
        self.data.act[self.model.actuator("robot/steer").actadr[0]] = heading
        mujoco.mj_forward(self.model, self.data)

    def control_step(self, *speeds: float) -> None:
        self.data.ctrl[:] = speeds
        for _ in range(10):
            mujoco.mj_step2(self.model, self.data)
            mujoco.mj_step1(self.model, self.data)
            self.driven += self.read("translate_encoder") * self.model.opt.timestep

    def go(self, motor: int, amount: float, speed: float, ramp: float) -> None:
        """Drive or steer by `amount` [m or rad] by the encoder, with ramps [per s2]."""
        goal, command = (self.driven, self.read("steer_encoder"))[motor] + amount, 0.0
        for _ in range(600):
            error = goal - (self.driven, self.read("steer_encoder"))[motor]
            wish = np.clip(np.sqrt(1.6 * ramp * abs(error)), 0, min(speed, 10 * abs(error)))
            step = ramp * CONTROL_STEP
            command = float(np.clip(np.sign(error) * wish, command - step, command + step))
            if abs(error) < 2e-5 and abs(command) < 1e-3:
                break
            self.control_step(*(command if motor == i else 0.0 for i in range(3)))
        for _ in range(6):
            self.control_step(0, 0, 0)


@pytest.fixture(params=ROBOTS)
def robot(request: pytest.FixtureRequest) -> str:
    return str(request.param)


def test_has_the_names_that_controllers_rely_on(robot: str) -> None:
    model = in_scene(robot)
    assert [model.actuator(i).name for i in range(model.nu)] == [f"robot/{n}" for n in LIMITS]
    expected = [f"robot/bumper_{i}" for i in range(20)]
    expected += [f"robot/{motor}_encoder" for motor in LIMITS]
    for ring, (rays, *_) in RINGS.items():
        expected += [f"robot/{ring}_{r}_{c:02d}" for c in range(16) for r in range(rays)]
    assert [model.sensor(i).name for i in range(model.nsensor)] == expected
    assert model.cam("robot/chase").bodyid[0] == model.body("robot/base").id
    assert model.site("robot/drive").bodyid[0] == model.body("robot/steer").id


def test_has_the_numbers_of_the_real_robot(robot: str) -> None:
    model = in_scene(robot)
    assert model.body_subtreemass[0] == pytest.approx(59, abs=0.5)
    for name, speed in LIMITS.items():
        assert model.actuator(f"robot/{name}").ctrlrange == pytest.approx([-speed, speed], abs=1e-4)
        assert model.actuator(f"robot/{name}").forcerange[1] > 0
    for ring, (_, _, reach, _) in RINGS.items():
        assert model.sensor(f"robot/{ring}_0_00").cutoff[0] == reach
    assert model.numeric("robot/radius").data[0] == RADIUS


@pytest.mark.parametrize("ring", RINGS)
def test_rings_look_every_22_5_degrees_in_symmetrical_fans(robot: str, ring: str) -> None:
    nomad = Nomad(robot)
    rays, spacing, _, height = RINGS[ring]
    for cone, bearing in enumerate(BEARINGS):
        for ray in range(rays):
            site = nomad.data.site(f"robot/{ring}_{ray}_{cone:02d}")
            angle = np.radians(bearing + (ray - (rays - 1) / 2) * spacing)
            along = site.xmat.reshape(3, 3)[:, 2]
            np.testing.assert_allclose(along, [np.cos(angle), np.sin(angle), 0], atol=1e-9)
            assert np.hypot(*site.xpos[:2]) == pytest.approx(SITE_RADIUS, abs=1e-9)
            assert site.xpos[2] == pytest.approx(height, abs=1e-9)


def test_no_ray_meets_the_robot_or_the_floor(robot: str) -> None:
    nomad = Nomad(robot)
    rays = nomad.model.sensor_adr[nomad.model.sensor_type == RANGEFINDER]
    for angle in np.linspace(0, 2 * np.pi, 25):
        nomad.place(0, 0, 1.7 * angle, angle)
        assert (nomad.data.sensordata[rays] < 0).all()


@pytest.mark.parametrize("ring", RINGS)
def test_a_wall_is_read_where_it_is_at_every_bearing(robot: str, ring: str) -> None:
    nomad = Nomad(robot, "wall")
    middle = RINGS[ring][0] // 2
    for distance in (0.05, 0.4):
        for cone, bearing in enumerate(BEARINGS):
            nomad.place(0, 0, 0, turret=0.3)
            nomad.move_obstacle(RADIUS + distance + 0.1, bearing + np.degrees(0.3))
            reading = nomad.read(f"{ring}_{middle}_{cone:02d}")
            assert reading - (RADIUS - SITE_RADIUS) == pytest.approx(distance, abs=1e-9)


def test_rays_are_cast_once_a_control_step() -> None:
    nomad = Nomad("nomad200", "wall")
    nomad.move_obstacle(2, 0)
    nomad.data.ctrl[0] = 0.5
    readings: set[float] = set()
    for _ in range(100):
        mujoco.mj_step(nomad.model, nomad.data)
        readings.add(nomad.read("sonar_2_00"))
    assert len(readings) == 10


@pytest.mark.parametrize("obstacle", ["wall", "pole"])
@pytest.mark.parametrize("depth", [1e-5, 5e-3])
def test_a_bumper_feels_every_direction(robot: str, obstacle: str, depth: float) -> None:
    nomad = Nomad(robot, obstacle)
    for direction in range(360):
        nomad.move_obstacle(RADIUS + 0.1 - depth, direction)
        felt = np.flatnonzero(nomad.bumpers())
        away = (18 * felt - direction + 180) % 360 - 180
        assert felt.size and np.abs(away).max() <= 24, (direction, felt)


def test_a_light_touch_is_still_known_at_the_end_of_the_control_step(robot: str) -> None:
    nomad = Nomad(robot, "wall")
    nomad.move_obstacle(RADIUS + 0.1 - 1e-4, 0)
    mujoco.mj_step(nomad.model, nomad.data)
    nomad.move_obstacle(5, 0)
    mujoco.mj_step(nomad.model, nomad.data, 9)
    assert nomad.bumpers().max() == 0
    values = nomad.model.sensor_historyadr[nomad.model.sensor("robot/bumper_0").id] + 12
    assert nomad.data.history[values : values + 10].max() > 0


def test_a_wall_stops_it(robot: str) -> None:
    nomad = Nomad(robot, "wall")
    nomad.move_obstacle(1.1, 0)
    inside = [0.0]
    for _ in range(80):
        nomad.control_step(LIMITS["translate"], 0, 0)
        inside.append(nomad.data.qpos[nomad.joints[0]] + RADIUS - 1)
    assert max(inside) < 0.015 and abs(inside[-1]) < 2e-4
    assert set(np.flatnonzero(nomad.bumpers())) <= {19, 0, 1}


@pytest.mark.parametrize(("robot", "tolerance"), [("nomad200", 1e-3), ("nomad200_wheels", 1e-2)])
def test_a_square_of_two_metres_closes(robot: str, tolerance: float) -> None:
    nomad = Nomad(robot)
    for corner in ((2, 0), (2, 2), (0, 2), (0, 0)):
        nomad.go(0, 2.0, 0.6, 0.76)
        nomad.go(1, np.pi / 2, 1.0, 0.87)
        np.testing.assert_allclose(nomad.data.qpos[nomad.joints[:2]], corner, atol=tolerance)
    assert nomad.data.qpos[nomad.joints[2]] == pytest.approx(2 * np.pi, abs=np.radians(0.1))


@pytest.mark.parametrize(("robot", "tolerance"), [("nomad200", 4e-3), ("nomad200_wheels", 2e-2)])
def test_an_arc_is_where_its_encoders_say(robot: str, tolerance: float) -> None:
    nomad = Nomad(robot)
    place, driven, heading = np.zeros(2), 0.0, 0.0
    for step in range(180):
        ramp = min(step + 1, 180 - step, 14) / 14
        nomad.control_step(0.5 * ramp, 0.5 * ramp, -0.5 * ramp)
        turned = nomad.read("steer_encoder")
        middle = (turned + heading) / 2
        place += (nomad.driven - driven) * np.array([np.cos(middle), np.sin(middle)])
        driven, heading = nomad.driven, turned
    np.testing.assert_allclose(nomad.data.qpos[nomad.joints[:2]], place, atol=tolerance)


def test_it_stays_where_a_reset_puts_it(robot: str) -> None:
    (nomad := Nomad(robot)).place(1, 2, 2.5)
    for _ in range(20):
        nomad.control_step(0, 0, 0)
    np.testing.assert_allclose(nomad.data.qpos[nomad.joints], [1, 2, 2.5, 0], atol=1e-6)


def test_force_limits_keep_it_near_the_real_acceleration(robot: str) -> None:
    nomad = Nomad(robot)
    for step in range(1, 5):
        nomad.control_step(LIMITS["translate"], 0, 0)
        assert nomad.read("translate_encoder") < 1.4 * 0.76 * step * CONTROL_STEP


def test_random_driving_raises_no_warning(robot: str) -> None:
    nomad = Nomad(robot)
    rng = np.random.default_rng(1)
    for _ in range(400):
        nomad.control_step(*(rng.uniform(-limit, limit) for limit in LIMITS.values()))
    assert nomad.data.warning.number.sum() == 0


def test_a_file_opens_and_steps_on_its_own(robot: str) -> None:
    file = MODELS / "robots" / "nomad200" / f"{robot}.xml"
    data = mujoco.MjData(model := mujoco.MjModel.from_xml_path(str(file)))
    data.ctrl[:] = 0.3, 0.2, 0.1
    mujoco.mj_step(model, data, 200)
    assert data.warning.number.sum() == 0
