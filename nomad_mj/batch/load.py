"""Load many environments at once: the batched form of `nomad_mj.load`."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypeAlias, overload

import numpy as np

from nomad_mj.batch.motor import BatchMotor
from nomad_mj.batch.path_finding import BatchPathFinding
from nomad_mj.batch.worlds import Worlds
from nomad_mj.envs import DEFAULT_ROBOT, DEFAULT_ROOM
from nomad_mj.envs.load_options import LoadOptions, read_options
from nomad_mj.errors import ConfigError
from nomad_mj.scene import Scene

Rooms: TypeAlias = "str | Path | Sequence[str | Path]"
Goal: TypeAlias = "Sequence[float] | None"
Goals: TypeAlias = "Sequence[float] | Sequence[Goal] | None"


@overload
def load_batch(
    task_name: Literal["path_finding"] = "path_finding",
    count: int | None = None,
    room: Rooms = DEFAULT_ROOM,
    robot: str | Path = DEFAULT_ROBOT,
    task_kwargs: Mapping[str, Any] | None = None,
    environment_kwargs: Mapping[str, Any] | None = None,
    *,
    goal: Goals = None,
    threads: int | None = None,
) -> BatchPathFinding: ...


@overload
def load_batch(
    task_name: Literal["motor"],
    count: int | None = None,
    room: Rooms = DEFAULT_ROOM,
    robot: str | Path = DEFAULT_ROBOT,
    task_kwargs: Mapping[str, Any] | None = None,
    environment_kwargs: Mapping[str, Any] | None = None,
    *,
    goal: Goals = None,
    threads: int | None = None,
) -> BatchMotor: ...


def load_batch(
    task_name: str = "path_finding",
    count: int | None = None,
    room: Rooms = DEFAULT_ROOM,
    robot: str | Path = DEFAULT_ROBOT,
    task_kwargs: Mapping[str, Any] | None = None,
    environment_kwargs: Mapping[str, Any] | None = None,
    *,
    goal: Goals = None,
    threads: int | None = None,
) -> BatchPathFinding | BatchMotor:
    """Return many environments in one: as many robots, side by side in one process.

    Parameters
    ----------
    task_name : "path_finding" or "motor"
        As of `load`.
    count : int, optional
        How many robots; None for one in each room of a list.
    room : str, Path or sequence of these
        One room for all, or several: world i is in the i-th of them, and after the last one the
        first is next.
    robot : str or Path
        The same for all.
    task_kwargs, environment_kwargs : mapping, optional
        As of `load`. With ``random`` s, world i is the single environment of seed s + i; with a
        SeedSequence that of its child i; with a list that of its i-th.
    goal : (float, float) or sequence of these, optional
        Where the goal is [m], in place of the rooms' own: one for all, or as many as worlds, None
        for a room's own.
    threads : int, optional
        To simulate on; None for one a processor that this process may use.

    Raises
    ------
    NomadError
        Anything wrong with these, in one line.
    """
    options = read_options(task_name, task_kwargs, environment_kwargs)
    rooms = [room] if isinstance(room, str | Path) else _listed("room", room)
    if not rooms:
        raise ConfigError("room: the list of rooms is empty; name one at least")
    worlds = _whole("count", len(rooms) if count is None else count)
    used = _whole("threads", _processors() if threads is None else threads)
    scenes = _scenes(options, rooms, robot, _goals(goal, worlds))
    made = Worlds(scenes, options.motor, options.random, used)
    if task_name == "motor":
        return BatchMotor(made, **options.environment)
    return BatchPathFinding(made, options.path_finding, **options.environment)


def _scenes(
    options: LoadOptions, rooms: Sequence[str | Path], robot: str | Path, goals: Sequence[Goal]
) -> list[Scene]:
    """Return the scene of each world; worlds that are alike share theirs."""
    made: dict[tuple[str, str | None], Scene] = {}
    scenes: list[Scene] = []
    for world, goal in enumerate(goals):
        room = rooms[world % len(rooms)]
        key = str(room), None if goal is None else str(list(goal))
        if key not in made:
            made[key] = options.build_scene(room, robot, goal)
        scenes.append(made[key])
    return scenes


def _goals(goal: Goals, worlds: int) -> list[Goal]:
    """Return the goal of each world, given one for all or one for each."""
    if goal is None:
        return [None] * worlds
    given = _listed("goal", goal)
    if all(isinstance(number, int | float | np.number) for number in given):
        return [given] * worlds
    if len(given) != worlds:
        raise ConfigError(f"goal: there are {len(given)}, but {worlds} worlds; give one for each")
    return given


def _listed(name: str, given: Any) -> list[Any]:
    """Return what is given for each world as a list; raise ConfigError if it is none."""
    if isinstance(given, str) or not isinstance(given, Sequence | np.ndarray):
        raise ConfigError(f"{name} {given!r}: must be one for all worlds, or a list of these")
    return list(given)


def _whole(name: str, value: Any) -> int:
    """Return an option that must be a whole number from 1 on; raise ConfigError if it is not."""
    is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not is_whole or value < 1:
        raise ConfigError(f"{name} {value!r}: must be 1, 2, 3, ...")
    return int(value)


def _processors() -> int:
    """Return how many processors this process may use: fewer than there are in a container."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
