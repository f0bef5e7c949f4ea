"""Load an environment by name, as dm_control's users expect."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np

from nomad_mj.envs.load_options import DEFAULT_ROBOT, DEFAULT_ROOM, read_options
from nomad_mj.envs.path_finding import PathFinding
from nomad_mj.tasks import MotorEnvironment, MotorTask


@overload
def load(
    task_name: Literal["path_finding"] = "path_finding",
    room: str | Path = DEFAULT_ROOM,
    robot: str | Path = DEFAULT_ROBOT,
    task_kwargs: Mapping[str, Any] | None = None,
    environment_kwargs: Mapping[str, Any] | None = None,
    *,
    goal: Sequence[float] | None = None,
) -> PathFinding: ...


@overload
def load(
    task_name: Literal["motor"],
    room: str | Path = DEFAULT_ROOM,
    robot: str | Path = DEFAULT_ROBOT,
    task_kwargs: Mapping[str, Any] | None = None,
    environment_kwargs: Mapping[str, Any] | None = None,
    *,
    goal: Sequence[float] | None = None,
) -> MotorEnvironment: ...


def load(
    task_name: str = "path_finding",
    room: str | Path = DEFAULT_ROOM,
    robot: str | Path = DEFAULT_ROBOT,
    task_kwargs: Mapping[str, Any] | None = None,
    environment_kwargs: Mapping[str, Any] | None = None,
    *,
    goal: Sequence[float] | None = None,
) -> PathFinding | MotorEnvironment:
    """Return an environment.

    Parameters
    ----------
    task_name : "path_finding" or "motor"
        Decisions (dx, dy), or motor velocities at 20 Hz.
    room, robot : str or Path
        The name of one that comes with the package, or an MJCF file.
    task_kwargs : mapping, optional
        ``random`` (seed), ``rays_per_cone``, ``moving_goal`` (a `MovingGoal`),
        ``moving_obstacles`` (a `MovingObstacles`) and the fields of `MotorConfig`; for path
        finding those of `PathFindingConfig` too.
    environment_kwargs : mapping, optional
        ``time_limit`` [s]; for the motor task ``flat_observation`` too.
    goal : (float, float), optional
        Where the goal is [m], in place of the room's own.

    Raises
    ------
    NomadError
        Anything wrong with these, in one line.
    """
    options = read_options(task_name, task_kwargs, environment_kwargs)
    task = MotorTask(options.build_scene(room, robot, goal), options.motor, options.random)
    if task_name == "motor":
        return MotorEnvironment(task, **options.environment)
    motor = MotorEnvironment(task, time_limit=np.inf)
    return PathFinding(motor, options.path_finding, **options.environment)
