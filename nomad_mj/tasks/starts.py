"""Where an episode starts: a start of the room's, or a pose of the user's that is checked."""

import math
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import shapely

from nomad_mj.errors import StartError, UnknownNameError
from nomad_mj.movers import Movers
from nomad_mj.scene import Scene
from nomad_mj.types import Pose

_TURNS = 100.0  # [rad]
_TRIED = 20  # starts at which moving obstacles find no place
Start: TypeAlias = "str | int | Sequence[float] | None"


def resolve_start(scene: Scene, start: Start, rng: np.random.Generator) -> Pose:
    """Return the pose that `start` means in a scene.

    Parameters
    ----------
    scene : Scene
        Its arena's starts and its floor plan.
    start : str, int, sequence of float or None
        The name or number of a start of the room's; ``(x, y)`` or ``(x, y, heading)`` in metres
        and radians; None for one of the room's starts at random.
    rng : numpy.random.Generator
        Chooses among the starts.

    Raises
    ------
    UnknownNameError
        A name that no start has.
    StartError
        A number that no start has, a pose that is malformed, in an obstacle or cut off from the
        goal.
    """
    arena = scene.arena
    if start is None:
        return Pose(*arena.starts[rng.integers(len(arena.starts))].tolist())
    if isinstance(start, str):
        if start not in arena.start_names:
            raise UnknownNameError("start", start, arena.start_names)
        return Pose(*arena.starts[arena.start_names.index(start)].tolist())
    if isinstance(start, int | np.integer):
        if isinstance(start, bool) or not 0 <= start < len(arena.starts):
            raise StartError(f"start {start}: the room's are numbered 0 to {len(arena.starts) - 1}")
        return Pose(*arena.starts[start].tolist())
    return _check(scene, start)


def start_movers(
    movers: Movers,
    scene: Scene,
    start: Pose,
    choice: np.random.Generator | None,
    obstacles: np.random.Generator,
    goal: np.random.Generator,
) -> Pose:
    """Let what moves begin an episode; return where the robot starts.

    Parameters
    ----------
    movers, scene
        What moves, and where.
    start : Pose
        Where the robot is to start.
    choice : Generator, optional
        Chooses another of the room's starts where the obstacles find no place; None: it must be
        this one.
    obstacles, goal : Generator
        Streams of what moves.

    Raises
    ------
    StartError
        There is no place for one of the obstacles.
    """
    if choice is not None:
        for _ in range(_TRIED):
            if _find_places(movers, start, obstacles, goal):
                return start
            start = resolve_start(scene, None, choice)
    movers.start(start[:2], obstacles, goal)
    return start


def _find_places(
    movers: Movers, start: Pose, obstacles: np.random.Generator, goal: np.random.Generator
) -> bool:
    try:
        movers.start(start[:2], obstacles, goal)
    except StartError:
        return False
    return True


def _check(scene: Scene, start: Sequence[float]) -> Pose:
    try:
        values = np.asarray(start, dtype=np.float64)
    except (TypeError, ValueError):  # not numbers, or not as many in every row
        values = np.array(np.nan)
    if values.shape not in ((2,), (3,)) or not np.isfinite(values).all():
        given = " ".join(str(start).split())
        raise StartError(f"start {given}: must be (x, y) or (x, y, heading) in metres and radians")
    x, y, *turned = values.tolist()
    heading = turned[0] if turned else 0.0
    if abs(heading) > _TURNS:  # numbers so large have lost their last digits
        heading = math.remainder(heading, 2 * math.pi)
    pose = Pose(x, y, heading)
    radius = scene.robot.layout.radius
    where = f"start ({pose.x:g}, {pose.y:g})"
    clearance = float(scene.plan.clearance(values[:2], radius))
    if clearance <= 0:
        raise StartError(
            f"{where} is {-clearance:.2f} m inside {scene.plan.nearest_name(values[:2])!r} for a "
            f"robot of radius {radius:g} m; the floor is {scene.plan.describe_bounds()}"
        )
    if not shapely.intersects_xy(scene.free_space, *values[:2]):
        raise StartError(
            f"{where} is cut off from the goal for a robot of radius {radius:g} m; the floor is "
            f"{scene.plan.describe_bounds()}"
        )
    return pose
