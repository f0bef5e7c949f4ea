"""What `load` and its batched form are told, checked: names, types, and what belongs where."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, cast, get_type_hints

import numpy as np

from nomad_mj.envs.path_finding import PathFindingConfig
from nomad_mj.errors import ConfigError, UnknownNameError
from nomad_mj.option_types import check_types
from nomad_mj.scene import Scene, build_scene
from nomad_mj.tasks import MotorConfig

TASKS = ("motor", "path_finding")
DEFAULT_ROOM = "paper_room"
DEFAULT_ROBOT = "nomad200"
SCENE_OPTIONS = ("rays_per_cone", "moving_goal", "moving_obstacles")
_TASK_TYPES = {
    "rays_per_cone": int | None,
    **get_type_hints(MotorConfig),
    **get_type_hints(PathFindingConfig),
}


@dataclass(frozen=True)
class LoadOptions:
    """Options of an environment, sorted by whom they concern.

    Attributes
    ----------
    random : int, SeedSequence or None
        Seed, as given.
    scene : mapping
        Options of `build_scene`.
    motor : MotorConfig
        Of the motor task.
    path_finding : PathFindingConfig
        Of path finding; the defaults for the motor task.
    environment : mapping
        Of the environment itself.
    """

    random: int | np.random.SeedSequence | None
    scene: Mapping[str, Any]
    motor: MotorConfig
    path_finding: PathFindingConfig
    environment: Mapping[str, Any]

    def build_scene(
        self, room: str | Path, robot: str | Path, goal: Sequence[float] | None
    ) -> Scene:
        """Return the scene of a room and a robot under these options."""
        noise = self.motor.range_noise
        rings = noise.specular_rings if noise.grazing is not None else ()
        return build_scene(room, robot, goal=goal, specular_rings=rings, **self.scene)


def read_options(
    task_name: str,
    task_kwargs: Mapping[str, Any] | None,
    environment_kwargs: Mapping[str, Any] | None,
) -> LoadOptions:
    """Check and sort options; parameters and errors as of `load`."""
    if task_name not in TASKS:
        raise UnknownNameError("task", task_name, TASKS)
    options = _mapping("task_kwargs", task_kwargs)
    environment = _mapping("environment_kwargs", environment_kwargs)
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
    if task_name == "path_finding":
        options["ends_at_goal"] = False
    return LoadOptions(
        random=options.pop("random", None),
        scene={name: options.pop(name) for name in SCENE_OPTIONS if name in options},
        motor=_config(MotorConfig, options),
        path_finding=_config(PathFindingConfig, options),
        environment=environment,
    )


def _mapping(what: str, given: Any) -> dict[str, Any]:
    if not isinstance(given, Mapping | None):
        raise ConfigError(f"{what}: must be a mapping of options, not {given!r}")
    return dict(cast("Mapping[str, Any]", given or {}))


def _config(cls: type[Any], options: dict[str, Any]) -> Any:
    """Return a config made of the `options` that it knows, taking them out."""
    return cls(**{f.name: options.pop(f.name) for f in fields(cls) if f.name in options})


def _refuse(what: str, given: Mapping[str, Any], known: list[str]) -> None:
    for name in given:
        if name not in known:
            raise ConfigError(f"unknown {what} {name!r}; there are: {', '.join(known)}")
