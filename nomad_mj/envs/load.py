"""Load an environment by name, as dm_control's users expect."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any, Literal, get_type_hints, overload

import numpy as np

from nomad_mj.envs.option_types import check_types
from nomad_mj.envs.path_finding import PathFinding, PathFindingConfig
from nomad_mj.errors import ConfigError, UnknownNameError
from nomad_mj.scene import Scene, build_scene
from nomad_mj.tasks import MotorConfig, MotorEnvironment, MotorTask, RangeNoise

TASKS = ("motor", "path_finding")
DEFAULT_ROOM = "paper_room"
DEFAULT_ROBOT = "nomad200"
SCENE_OPTIONS = ("rays_per_cone", "moving_goal", "moving_obstacles")
_TASK_TYPES = {
    "rays_per_cone": int | None,
    **get_type_hints(MotorConfig),
    **get_type_hints(PathFindingConfig),
}


def _config(cls: type[Any], options: dict[str, Any]) -> Any:
    """Return a config made of the `options` that it knows, taking them out."""
    return cls(**{f.name: options.pop(f.name) for f in fields(cls) if f.name in options})


def _refuse(what: str, given: Mapping[str, Any], known: list[str]) -> None:
    for name in given:
        if name not in known:
            raise ConfigError(f"unknown {what} {name!r}; there are: {', '.join(known)}")


def make_motor(scene: Scene, options: dict[str, Any]) -> MotorTask:
    """Return the motor task of a scene, taking its options (and ``random``) out of `options`."""
    random: int | np.random.SeedSequence | None = options.pop("random", None)
    return MotorTask(scene, _config(MotorConfig, options), random)


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
    if task_name not in TASKS:
        raise UnknownNameError("task", task_name, TASKS)
    options, environment = dict(task_kwargs or {}), dict(environment_kwargs or {})
    known = ["random", *SCENE_OPTIONS, *(f.name for f in fields(MotorConfig))]
    accepts = ["time_limit"]
    if task_name == "motor":
        accepts.append("flat_observation")
    else:
        known.remove("ends_at_goal")  # path finding itself ends the episode there
        known += [f.name for f in fields(PathFindingConfig)]
    _refuse("task option", options, known)
    _refuse("environment option", environment, accepts)
    check_types("task option", options, _TASK_TYPES)
    check_types("environment option", environment, {"time_limit": float, "flat_observation": bool})
    noise: RangeNoise = options.get("range_noise", RangeNoise())
    of_scene = {name: options.pop(name) for name in SCENE_OPTIONS if name in options}
    scene = build_scene(
        room,
        robot,
        goal=goal,
        specular_rings=noise.specular_rings if noise.grazing is not None else (),
        **of_scene,
    )
    if task_name == "motor":
        return MotorEnvironment(make_motor(scene, options), **environment)
    config = _config(PathFindingConfig, options)
    task = make_motor(scene, {**options, "ends_at_goal": False})
    return PathFinding(MotorEnvironment(task, time_limit=np.inf), config, **environment)
