"""Put a robot into a room: two MJCF files and the shared scene become one compiled model."""

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import mujoco
import numpy as np
import shapely

from nomad_mj.arenas import Arena, FloorPlan, check_arena, near_model
from nomad_mj.arenas.names import ROOM_PREFIX
from nomad_mj.assets import find_robot, find_room, models_dir
from nomad_mj.errors import ConfigError, ModelError
from nomad_mj.movers import (
    Moving,
    MovingGoal,
    MovingObstacles,
    add_obstacles,
    place_goal,
    read_moving,
)
from nomad_mj.reading import quietly, read_robot, read_room
from nomad_mj.robots import (
    PREFIX,
    RobotDescription,
    describe_robot,
    unclip_surfaces,
)

CONTROL_TIMESTEP = 0.05  # [s], the rate of the robot's own controller


@dataclass(frozen=True)
class Scene:
    """A robot in a room, ready to be simulated.

    Attributes
    ----------
    model : mujoco.MjModel
        Compiled; sensors sample once a control step.
    robot : RobotDescription
        Read from the robot's file.
    arena : Arena
        Starts, goal and cameras of the room.
    plan : FloorPlan
        Footprints of the room's obstacles, without those that move.
    moving : Moving
        The goal and the obstacles that move; false if none does.
    near_model : mujoco.MjModel, optional
        Of a large room what `Nearby` changes as the robot drives, to be copied for each simulation.
    """

    model: mujoco.MjModel
    robot: RobotDescription
    arena: Arena
    plan: FloorPlan
    moving: Moving
    near_model: mujoco.MjModel | None = None

    def simulated(self) -> mujoco.MjModel:
        """Return the model to simulate: of a large room a new copy of `near_model`."""
        return self.model if self.near_model is None else copy.copy(self.near_model)

    @property
    def shown_bounds(self) -> "tuple[float, float, float, float]":
        """What a picture of the room shows, (x0, y0, x1, y1) [m].

        All that stands in it, and goal and starts with a metre around where these are outside.
        """
        places = np.concatenate([self.arena.starts[:, :2], self.arena.goal[None]])
        low, high = places.min(axis=0), places.max(axis=0)
        if self.plan.footprints:
            bounds = self.plan.bounds
            low = np.where(low < bounds[:2], low - 1.0, bounds[:2])
            high = np.where(high > bounds[2:], high + 1.0, bounds[2:])
        else:
            low, high = low - 1.0, high + 1.0
        (x0, y0), (x1, y1) = low.tolist(), high.tolist()
        return x0, y0, x1, y1

    @cached_property
    def free_space(self) -> shapely.Polygon:
        """Where the robot's centre can be and still reach the goal, prepared for queries."""
        space = self.plan.free_space(self.robot.layout.radius, self.arena.goal)
        shapely.prepare(space)
        return space


def _sample_per_control_step(spec: mujoco.MjSpec, sub_steps: int) -> None:
    """Let rays be cast once a control step and fast sensors keep a history of it."""
    for sensor in spec.sensors:
        if sensor.type == mujoco.mjtSensor.mjSENS_RANGEFINDER:
            sensor.interval = [CONTROL_TIMESTEP, 0.0]
            sensor.nsample = max(sensor.nsample, 1)  # without a sample kept there is no interval
        elif sensor.type == mujoco.mjtSensor.mjSENS_TOUCH:
            sensor.nsample = sub_steps
        elif sensor.type == mujoco.mjtSensor.mjSENS_ACTUATORVEL:
            sensor.nsample = sub_steps - 1  # all but the last, which is in sensordata itself


def _join(
    room: mujoco.MjSpec, robot: mujoco.MjSpec, both: str
) -> tuple[mujoco.MjSpec, mujoco.MjModel]:
    """Return both in the shared scene, sensors sampling once a control step, and their model.

    Raises
    ------
    ModelError
        They do not fit together, in a line that begins with what `both` are.
    """
    try:
        spec = mujoco.MjSpec.from_file(str(models_dir() / "scene.xml"))
        with quietly():  # scene.xml owns the options: a file's own serve only where it is alone
            spec.attach(room, prefix=ROOM_PREFIX, frame=spec.worldbody.add_frame())
            spec.attach(robot, prefix=PREFIX, frame=spec.worldbody.add_frame())
            _sample_per_control_step(spec, round(CONTROL_TIMESTEP / spec.option.timestep))
            model = spec.compile()
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split())
        raise ModelError(f"{both} do not fit together: {reason}") from None
    _time_rays(model)
    return spec, model


def _time_rays(model: mujoco.MjModel) -> None:
    """Let rays be cast once a control step.

    The engine compares times without a tolerance: at the exact interval it skips samples.
    """
    rays = model.sensor_type == mujoco.mjtSensor.mjSENS_RANGEFINDER
    model.sensor_interval[rays, 0] = CONTROL_TIMESTEP - 1e-9


def _near_model(
    spec: mujoco.MjSpec, model: mujoco.MjModel, robot: RobotDescription
) -> mujoco.MjModel | None:
    """Return what to simulate of a large room; the spec is changed."""
    with quietly():
        few = near_model(spec, model, robot.reach)
    if few is not None:
        _time_rays(few)
        unclip_surfaces(few)
    return few


def _check_configs(moving_goal: object, moving_obstacles: object) -> None:
    for name, value, cls in (
        ("moving_goal", moving_goal, MovingGoal),
        ("moving_obstacles", moving_obstacles, MovingObstacles),
    ):
        if value is not None and not isinstance(value, cls):
            raise ConfigError(
                f"{name} {value!r}: must be a {cls.__name__}, such as nomad_mj.{cls.__name__}(), "
                "or left out"
            )


def build_scene(
    room: str | Path,
    robot: str | Path,
    *,
    rays_per_cone: int | None = None,
    specular_rings: Sequence[str] = (),
    goal: Sequence[float] | None = None,
    moving_goal: MovingGoal | None = None,
    moving_obstacles: MovingObstacles | None = None,
) -> Scene:
    """Compile a room and a robot into one model.

    Parameters
    ----------
    room, robot : str or Path
        A name (see `assets.list_rooms` and `assets.list_robots`) or an MJCF file.
    rays_per_cone : int, optional
        Overrides how many rays sample a cone of several rays.
    specular_rings : sequence of str
        Rings of range sensors whose rays report the surfaces they strike, as `RangeNoise.grazing`
        needs it; they take a little longer.
    goal : (float, float), optional
        Where the goal is [m], in place of the room's own.
    moving_goal : MovingGoal, optional
        How the goal moves; None for what the room's file says.
    moving_obstacles : MovingObstacles, optional
        Obstacles that move, beside those of the room's file.

    Raises
    ------
    NomadError
        A file that is missing or malformed, an element that is missing, a start inside an
        obstacle, a goal that cannot be reached.
    """
    _check_configs(moving_goal, moving_obstacles)
    room_path, robot_path = find_room(room), find_robot(robot)
    room_spec = read_room(room_path)
    robot_spec = read_robot(robot_path, rays_per_cone, specular_rings)
    if goal is not None or moving_goal is not None:
        place_goal(room_spec, goal, moving_goal is not None)
    added = add_obstacles(room_spec, moving_obstacles) if moving_obstacles else ()
    spec, model = _join(room_spec, robot_spec, f"room {str(room)!r} and robot {str(robot)!r}")
    description = describe_robot(model, robot_path.stem)
    unclip_surfaces(model)
    arena = Arena.from_model(model, room_path.stem)
    plan = FloorPlan.from_model(model, description.height, exclude_body_prefix=PREFIX)
    check_arena(plan, arena, description.layout.radius)
    half = description.limits.translate / 2  # the paper's limit
    moving = read_moving(model, arena.name, half, moving_goal, moving_obstacles, added)
    return Scene(model, description, arena, plan, moving, _near_model(spec, model, description))
