"""The robots beside the Nomad 200 in the scene, driven by mujoco alone: what their tests share."""

from functools import cache
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np

from nomad_mj.types import FloatArray

MODELS = Path(__file__).resolve().parents[2] / "models"
CONTROL_STEP = 0.05
RANGEFINDER, TOUCH = mujoco.mjtSensor.mjSENS_RANGEFINDER, mujoco.mjtSensor.mjSENS_TOUCH
SPEEDS = ("translate_max_speed", "turn_max_speed")
NUMBERS = (*SPEEDS, "radius", "translate_max_acceleration", "turn_max_acceleration")


class Facts(NamedTuple):
    """What a file must hold: bearings of its cones [deg], rays of a cone, their spread [deg]."""

    mass: float
    actuators: tuple[str, ...]
    ring: str
    bearings: tuple[int, ...]
    rays: int
    spread: int
    bumpers: int
    guarded: int  # pushed this far [deg] from ahead or behind, a bumper feels it
    tolerance: tuple[float, float]  # of a square by dead reckoning [m, deg]


LEFT = (10, 30, 50, 90, 90, 130, 150, 170)
UNEVEN = (*LEFT, *(-bearing for bearing in LEFT[::-1]))
EVEN, BEAMS = tuple(range(0, 360, 45)), tuple(range(0, 360, 5))
WHEELS = ("wheel_0", "wheel_1", "wheel_2")
FACTS = {
    "pioneer": Facts(9, ("left", "right"), "sonar", UNEVEN, 5, 30, 10, 90, (1e-3, 0.05)),
    "khepera": Facts(0.54, ("left", "right"), "infrared", EVEN, 5, 40, 0, 0, (4e-3, 0.15)),
    "omnibot": Facts(20, WHEELS, "lidar", BEAMS, 1, 0, 10, 90, (1e-4, 1e-2)),
    "racer": Facts(3.74, ("drive", "steer"), "lidar", BEAMS, 1, 0, 2, 60, (0, 0)),
}
TURNERS = ("pioneer", "khepera", "omnibot")
TYRES = {"pioneer": (0.0975, 0.33), "khepera": (0.021, 0.1054)}  # radius, track [m]
PLACES = np.radians([60, 180, 300])  # of the omni wheels
OMNI = np.stack([-np.sin(PLACES), np.cos(PLACES), np.full(3, 0.135)], axis=1)


@cache
def in_scene(name: str) -> mujoco.MjModel:
    """Return the robot on the scene's floor, with a wall that can be put anywhere."""
    spec = mujoco.MjSpec.from_file(str(MODELS / "scene.xml"))
    spec.compiler.conflict = mujoco.mjtConflict.mjCONFLICT_ERROR
    wall = spec.worldbody.add_body(name="wall", mocap=True, pos=[0, 0, -9])
    wall.add_geom(name="wall", type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 2, 0.45])
    robot = mujoco.MjSpec.from_file(str(MODELS / "robots" / name / f"{name}.xml"))
    spec.attach(robot, prefix="robot/", frame=spec.worldbody.add_frame())
    model = spec.compile()
    model.sensor_interval[model.sensor_type == RANGEFINDER, 0] = CONTROL_STEP - 1e-9
    return model


class Robot:
    """A robot driven by whole-robot speeds, and where its wheels say that it is."""

    def __init__(self, name: str) -> None:
        self.name, self.model = name, in_scene(name)
        self.data = mujoco.MjData(self.model)
        self.reckoned = np.zeros(3)
        mujoco.mj_forward(self.model, self.data)
        self.drive([(0, 0)] * 4)  # settle on the wheels

    def number(self, name: str) -> float:
        return float(self.model.numeric(f"robot/{name}").data[0])

    def pose(self) -> FloatArray:
        axes = self.data.body("robot/base").xmat.reshape(3, 3)
        place = self.data.body("robot/base").xpos
        return np.array([place[0], place[1], np.arctan2(axes[1, 0], axes[0, 0])])

    def error(self) -> tuple[float, float]:
        """Return how far the true pose is from the reckoned one [m, deg]."""
        apart = self.pose() - self.reckoned
        turned = np.degrees(np.angle(np.exp(1j * apart[2])))
        return float(np.hypot(*apart[:2])), abs(float(turned))

    def touched(self) -> list[int]:
        """Return the numbers of the bumpers that are pressed."""
        return [
            int(self.model.sensor(int(i)).name.rpartition("_")[2])
            for i in np.flatnonzero(self.model.sensor_type == TOUCH)
            if self.data.sensordata[self.model.sensor_adr[i]] > 0
        ]

    def put_wall(self, distance: float, bearing: float) -> None:
        """Put the wall's face `distance` [m] from the origin, at `bearing` [rad]."""
        away = distance + 0.1
        self.data.mocap_pos[0] = [away * np.cos(bearing), away * np.sin(bearing), 0.45]
        self.data.mocap_quat[0] = [np.cos(bearing / 2), 0, 0, np.sin(bearing / 2)]
        mujoco.mj_forward(self.model, self.data)

    def reach(self, bearing: float) -> dict[str, float]:
        """Return how far each colliding geom stretches towards `bearing` [m]."""
        self.put_wall(1, bearing)
        geoms = [self.model.geom(i) for i in np.flatnonzero(self.model.geom_contype)]
        return {
            geom.name: 1
            - mujoco.mj_geomDistance(
                self.model, self.data, geom.id, self.model.geom("wall").id, 2, None
            )
            for geom in geoms
            if geom.name.startswith("robot/")
        }

    def wheel_speeds(self) -> FloatArray:
        """Return the body's speeds [m/s, m/s, rad/s] by what the wheels measure."""
        wheels = self.data.actuator_velocity[: self.model.nu]
        if self.name == "omnibot":
            return np.linalg.solve(OMNI, wheels)
        radius, track = TYRES[self.name]
        left, right = wheels * radius
        return np.array([(left + right) / 2, 0, (right - left) / track])

    def command(self, speed: float, turn: float) -> None:
        if self.name == "racer":
            self.data.ctrl[:] = speed, turn  # its second command is the angle of steering
        elif self.name == "omnibot":
            self.data.ctrl[:] = OMNI @ [speed, 0, turn]
        else:
            radius, track = TYRES[self.name]
            self.data.ctrl[:] = np.array([speed, speed]) / radius
            self.data.ctrl[:] += np.array([-turn, turn]) * track / 2 / radius

    def drive(self, commands: list[tuple[float, float]]) -> None:
        """Drive a control step by each command, and sum up what the wheels turn."""
        step = self.model.opt.timestep
        for command in commands:
            self.command(*command)
            for _ in range(10):
                heading = self.reckoned[2]
                mujoco.mj_step2(self.model, self.data)
                mujoco.mj_step1(self.model, self.data)
                if self.name != "racer":
                    ahead, aside, turned = self.wheel_speeds() * step
                    along, across = np.cos(heading), np.sin(heading)
                    self.reckoned += [
                        along * ahead - across * aside,
                        across * ahead + along * aside,
                        turned,
                    ]

    def go(self, distance: float = 0.0, angle: float = 0.0) -> None:
        """Drive straight [m] or turn [rad], with ramps at the robot's limits, and stand."""
        kind = "translate" if distance else "turn"
        speed, amount = self.number(f"{kind}_max_speed"), distance or angle
        rise = round(speed / self.number(f"{kind}_max_acceleration") / CONTROL_STEP) or 1
        ramp = np.arange(1, rise + 1) / rise
        level = max(0, round(amount / speed / CONTROL_STEP - rise))
        profile = np.concatenate([ramp, np.ones(level), 1 - ramp])
        profile *= amount / profile.sum() / CONTROL_STEP
        both = [(s, 0.0) if distance else (0.0, s) for s in profile.tolist()]
        self.drive([*both, *[(0.0, 0.0)] * 6])
