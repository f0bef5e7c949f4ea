"""Maps of ROS's map server, and plain images of a floor."""

import difflib
import math
from pathlib import Path
from typing import Any

import numpy as np

from nomad_mj.errors import ModelError
from nomad_mj.rooms.images import read_image
from nomad_mj.rooms.occupancy import FREE, OCCUPIED, UNKNOWN, Occupancy
from nomad_mj.rooms.rectangles import Mask
from nomad_mj.types import FloatArray
from nomad_mj.values import number, numbers, read_yaml

MODES = ("trinary", "scale", "raw")
_OPTIONAL = ("origin", "negate", "occupied_thresh", "free_thresh")  # `mode` is like many a word
_ALIKE = 0.88  # orgin and free_threshold are, original and negative are not
_OCCUPIED, _FREE = 0.65, 0.25  # defaults of the map server in ROS 2
_UNSURE = 0.5  # of `scale`, between free and occupied


def read_ros_map(path: Path) -> Occupancy:
    """Return the map that a YAML file of ROS's map server describes.

    It has ``image`` (a file beside it, or any path), ``resolution`` [m], ``origin`` (x, y, yaw of
    the lower left corner; [m], [rad]), ``negate``, ``occupied_thresh``, ``free_thresh`` and
    ``mode``: `trinary`, `scale` (of what lies between the thresholds the darker half is occupied)
    or `raw` (a pixel is the percentage). All but the first two may be left out. Transparent
    pixels are unknown. Other keys are ignored, but for what is nearly one of these that is missing.

    Raises
    ------
    ModelError
        A file that is missing or no map, a key that is misspelt, a value that makes no sense.
    """
    what = f"map {str(path)!r}:"
    held = read_yaml(path, "room")
    for key in ("image", "resolution"):
        if key not in held:
            raise ModelError(f"{what} has no {key!r}; a map needs image and resolution")
    _refuse_misspelt(held, what)
    image = held["image"]
    if not isinstance(image, str) or not image or "\0" in image:
        raise ModelError(f"{what} image {image!r}: must be the name of a file")
    resolution = number(held["resolution"], f"{what} resolution", 1e-4, 100)
    origin = numbers(held.get("origin", [0, 0, 0]), f"{what} origin", 2, 3)
    yaw = origin[2] if len(origin) == 3 else 0.0
    brightness, opaque = read_image(path.parent / image)
    cells = _classify(brightness, opaque, held, what)
    return Occupancy(np.flipud(cells), resolution, (origin[0], origin[1], yaw))


def _refuse_misspelt(held: dict[Any, Any], what: str) -> None:
    """Raise ModelError for a key that is nearly one of a map's: a default would stand for it."""
    for key in held:
        for meant in difflib.get_close_matches(str(key).lower(), _OPTIONAL, 1, _ALIKE):
            if meant not in held:
                raise ModelError(f"{what} knows no {str(key)!r}; is it {meant!r}?")


def read_floor_image(path: Path, resolution: float, origin: tuple[float, float]) -> Occupancy:
    """Return the map in an image: dark is occupied, bright is free, in between is unknown.

    Parameters
    ----------
    path : Path
        A PGM, PNG or BMP file.
    resolution : float
        Side of a pixel [m].
    origin : (float, float)
        Where the image's lower left corner is [m].
    """
    if not (math.isfinite(resolution) and 1e-4 <= resolution <= 100):
        raise ModelError(f"resolution {resolution:g}: must be 0.0001 to 100 metres a pixel")
    cells = _classify(*read_image(path), {}, f"image {str(path)!r}:")
    return Occupancy(np.flipud(cells), resolution, (*origin, 0.0))


def _classify(
    brightness: FloatArray, opaque: Mask, held: dict[Any, Any], what: str
) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Return the cell of each pixel, as ROS's map server reads it."""
    negate = held.get("negate", 0)
    if negate not in (0, 1):
        raise ModelError(f"{what} negate {negate!r}: must be 0 or 1")
    occupied_above = number(held.get("occupied_thresh", _OCCUPIED), f"{what} occupied_thresh", 0, 1)
    free_below = number(held.get("free_thresh", _FREE), f"{what} free_thresh", 0, 1)
    if free_below > occupied_above:
        raise ModelError(
            f"{what} free_thresh {free_below:g} must not be above occupied_thresh "
            f"{occupied_above:g}"
        )
    mode = held.get("mode", "trinary")
    if mode not in MODES:
        raise ModelError(f"{what} mode {mode!r}; there are: {', '.join(MODES)}")
    darkness = brightness if negate else 1 - brightness
    known = opaque
    if mode == "raw":
        darkness = np.round(brightness * 255) / 100
        known = opaque & (darkness <= 1)
    if mode == "scale":
        middle = free_below + _UNSURE * (occupied_above - free_below)
        occupied, free = known & (darkness > middle), known & (darkness <= middle)
    else:
        occupied, free = known & (darkness > occupied_above), known & (darkness < free_below)
    cells = np.full(brightness.shape, UNKNOWN, dtype=np.uint8)
    cells[occupied], cells[free] = OCCUPIED, FREE
    return cells
