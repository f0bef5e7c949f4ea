"""The standard sets: rooms made by seed, or that come along, and conditions to drive in them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from nomad_agents.benchmark.conditions import USUAL
from nomad_agents.checkpoint import write_atomically
from nomad_mj.assets import find_room
from nomad_mj.errors import ConfigError, UnknownNameError
from nomad_mj.rooms import (
    Room,
    concave_room,
    convex_room,
    furnish,
    maze_room,
    to_mjcf,
    wide_room,
)

TIME_LIMIT = 120.0  # [s]: some four times what a good way takes
DECISIONS = 100
_MAZE_TIME_LIMIT, _MAZE_DECISIONS = 240.0, 200
_DIFFICULTY, _MAZE_DIFFICULTY = 0.5, 0.25


@dataclass(frozen=True)
class Case:
    """One task: a room, and under which conditions.

    Attributes
    ----------
    name : str
        Which of its set.
    room : str or callable
        Name or file of a room, or what makes one, still without starts.
    condition : str
        A name of `conditions.CONDITIONS`.
    time_limit : float
        An evaluated episode is given up after this [s].
    decisions : int
        Or after so many decisions.
    """

    name: str
    room: str | Callable[[], Room]
    condition: str = USUAL
    time_limit: float = TIME_LIMIT
    decisions: int = DECISIONS


@dataclass(frozen=True)
class TaskSet:
    """Tasks of one kind.

    Attributes
    ----------
    name : str
        As on the command line.
    about : str
        What is hard in it, in a sentence.
    cases : tuple of Case
        The tasks.
    """

    name: str
    about: str
    cases: tuple[Case, ...]


def _made(maker: Callable[[int, float], Room], seed: int) -> Callable[[], Room]:
    return partial(maker, seed, _DIFFICULTY)


def _maze(seed: int) -> Case:
    room = partial(maze_room, seed, _MAZE_DIFFICULTY)
    return Case(str(seed), room, USUAL, _MAZE_TIME_LIMIT, _MAZE_DECISIONS)


_STANDARD = (
    TaskSet(
        "convex",
        "Ten rooms of convex obstacles: what every robot should master.",
        tuple(Case(str(seed), _made(convex_room, seed)) for seed in range(10)),
    ),
    TaskSet(
        "wide",
        "Free-standing walls wider than the view of 2 m: no end of them is seen from the middle.",
        tuple(Case(str(seed), _made(wide_room, seed)) for seed in range(3)),
    ),
    TaskSet(
        "concave",
        "Obstacles in the shape of a U, from which the robot must turn back; one room is the "
        "paper's.",
        (
            *(Case(str(seed), _made(concave_room, seed)) for seed in range(2)),
            Case("paper", "concave_room"),
        ),
    ),
    TaskSet(
        "moving",
        "The goal drifts about, or four obstacles do, or three people walk.",
        tuple(
            Case(condition, _made(convex_room, seed), condition)
            for seed, condition in enumerate(("moving goal", "moving obstacles", "people"))
        ),
    ),
    TaskSet(
        "noisy",
        "Lost and false echoes, odometry that is wrong by up to 0.3 m and turns by 1° a metre, "
        "and both, in the first room of convex.",
        tuple(
            Case(condition, _made(convex_room, 0), condition)
            for condition in ("poor ranges", "poor odometry", "poor sensors")
        ),
    ),
    TaskSet(
        "maze",
        "Mazes of 13 x 13 m: long ways round, past many openings.",
        tuple(_maze(seed) for seed in range(3)),
    ),
)
SETS: Mapping[str, TaskSet] = {each.name: each for each in _STANDARD}


def find_set(name: str) -> TaskSet:
    """Return the standard set of a name; raise UnknownNameError if there is none."""
    if name not in SETS:
        raise UnknownNameError("set", name, SETS)
    return SETS[name]


def room_sets(rooms: Sequence[str]) -> list[TaskSet]:
    """Return a set of one task for each room, named like it.

    Raises
    ------
    ConfigError
        Two rooms, or a room and a standard set, of the same name.
    """
    names = [Path(room).stem for room in rooms]
    for name, room in zip(names, rooms, strict=True):
        find_room(room)
        if names.count(name) > 1 or name in SETS:
            raise ConfigError(f"room {room!r}: another room or set is called {name!r} too")
    return [
        TaskSet(name, f"The room {name}.", (Case(name, room),))
        for name, room in zip(names, rooms, strict=True)
    ]


def write_room(case: Case, folder: Path) -> str:
    """Return the name or file of a case's room; one that is made is written there, with starts.

    Raises
    ------
    OutputError
        It cannot be written.
    """
    if isinstance(case.room, str):
        return case.room
    room = furnish(case.room())
    path = folder / f"{room.name}.xml"
    text = to_mjcf(room).encode()
    if not path.exists() or path.read_bytes() != text:
        write_atomically(path, lambda file: file.write(text))
    return str(path)
