"""Colours of what is drawn over the simulation: all numbers are sRGB in [0, 1]."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from nomad_mj.types import FloatArray

RGB: TypeAlias = tuple[float, float, float]

# Blue and orange stay apart for every kind of colour blindness; greens belong to the goal.
BLUE: RGB = (0.11, 0.40, 0.80)
ORANGE: RGB = (0.90, 0.47, 0.06)
GREY: RGB = (0.42, 0.45, 0.50)
GREEN: RGB = (0.09, 0.60, 0.44)

INK: RGB = (0.12, 0.14, 0.18)
MUTED: RGB = (0.43, 0.46, 0.51)
GROUND: RGB = (0.93, 0.925, 0.915)
PAPER: RGB = (0.99, 0.99, 0.985)

# Near is dark and warm, far fades into the floor: lightness rises steadily with the range.
_RAMP: tuple[RGB, ...] = (
    (0.56, 0.04, 0.22),
    (0.82, 0.18, 0.22),
    (0.93, 0.45, 0.20),
    (0.90, 0.64, 0.30),
    (0.71, 0.74, 0.71),
)
_STEPS = 256

_TO_LMS = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
_TO_LAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)


def _to_oklab(colours: FloatArray) -> FloatArray:
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    return np.cbrt(linear @ _TO_LMS.T) @ _TO_LAB.T


def _from_oklab(lab: FloatArray) -> FloatArray:
    linear = (lab @ np.linalg.inv(_TO_LAB).T) ** 3 @ np.linalg.inv(_TO_LMS).T
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)


def blend(colours: Sequence[RGB], share: npt.ArrayLike) -> FloatArray:
    """Return colours between those of a ramp, mixed in the OKLab space as the eye would.

    Parameters
    ----------
    colours : sequence of RGB
        Evenly spaced along the ramp.
    share : array (...)
        Where on the ramp, in [0, 1].

    Returns
    -------
    array (..., 3)
    """
    lab = _to_oklab(np.asarray(colours, dtype=np.float64))
    place = np.clip(np.asarray(share, dtype=np.float64), 0.0, 1.0) * (len(lab) - 1)
    low = np.minimum(place.astype(np.intp), len(lab) - 2)
    part = (place - low)[..., None]
    return _from_oklab(lab[low] * (1 - part) + lab[low + 1] * part)


_RANGES = blend(_RAMP, np.linspace(0.0, 1.0, _STEPS))


def range_colours(ranges: FloatArray, far: float) -> FloatArray:
    """Return the colour and opacity of range readings.

    Parameters
    ----------
    ranges : array (...)
        Readings [m].
    far : float
        From here on [m] all look alike.

    Returns
    -------
    array (..., 4)
        RGBA; nearer is warmer, darker and more opaque.
    """
    share = np.sqrt(np.clip(ranges / far, 0.0, 1.0))
    colour = _RANGES[(share * (_STEPS - 1)).astype(np.intp)]
    return np.concatenate([colour, (0.95 - 0.5 * share)[..., None]], axis=-1)
