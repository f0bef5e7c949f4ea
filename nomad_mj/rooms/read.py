"""Any file that holds a room but is no MJCF, as a room."""

import math
import os
from pathlib import Path

from nomad_mj.errors import ConfigError, ModelError
from nomad_mj.rooms.images import SUFFIXES
from nomad_mj.rooms.occupancy import room_of_map
from nomad_mj.rooms.places import furnish
from nomad_mj.rooms.plan_file import read_plan
from nomad_mj.rooms.room import Room
from nomad_mj.rooms.ros_map import read_floor_image, read_ros_map
from nomad_mj.values import read_yaml

YAML = (".yaml", ".yml")


def read_room(
    path: Path,
    *,
    resolution: float | None = None,
    goal: tuple[float, float] | None = None,
    starts: int | None = None,
    within: float = math.inf,
) -> Room:
    """Return the room in a file, with a goal and starts that a Nomad 200 can reach.

    Parameters
    ----------
    path : Path
        A YAML file of ROS's map server (see `read_ros_map`), a room plan (see `read_plan`), or an
        image (see `read_floor_image`).
    resolution : float, optional
        Of an image, metres a pixel; for no other file.
    goal : (float, float), optional
        In the frame of the file [m], in place of the file's own or of the most open place.
    starts : int, optional
        How many, in place of the file's own; up to 20 by default.
    within : float
        Of a map, only what is no farther than this from the goal in x and y [m].

    Raises
    ------
    NomadError
        In one line: a file that is missing or damaged, no free space, a goal in something.
    """
    if within <= 0 or math.isnan(within):
        raise ConfigError(f"within {within:g}: must be above 0 m")
    _check(path, resolution)
    if resolution is None and "image" not in read_yaml(path, "room"):
        if math.isfinite(within):
            raise ConfigError(f"within {within:g}: a part is taken of a map, and this is a plan")
        return furnish(read_plan(path), goal, starts)
    if resolution is None:
        grid = read_ros_map(path)
    else:
        grid = read_floor_image(path, resolution, (0.0, 0.0))
    try:
        room = room_of_map(grid, path.stem, goal, within)
    except ModelError as error:
        raise ModelError(f"map {str(path)!r}: {error}") from None
    return furnish(room, None, starts)


def _check(path: Path, resolution: float | None) -> None:
    """Make sure that there is a file of a known kind, and a resolution for an image alone."""
    is_image = path.suffix.lower() in SUFFIXES
    if not os.path.isfile(path):  # noqa: PTH113 - unlike Path.is_file no error for long names
        raise ModelError(f"room file {str(path)[:200]!r} does not exist")
    if not is_image and path.suffix.lower() not in YAML:
        raise ModelError(
            f"room file {str(path)!r}: its name must end in one of {', '.join(YAML + SUFFIXES)}; "
            "MJCF files need no conversion"
        )
    if is_image != (resolution is not None):
        told = "an image needs" if is_image else "only an image takes"
        raise ConfigError(f"{told} a resolution, in metres a pixel: {str(path)!r}")
