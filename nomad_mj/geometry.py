"""Angles and frames in the plane, over leading batch dimensions."""

import numpy as np
import numpy.typing as npt

from nomad_mj.types import FloatArray


def wrap_angle(angle: npt.ArrayLike) -> FloatArray:
    """Return the same direction in [-pi, pi) [rad]."""
    return (np.asarray(angle, dtype=np.float64) + np.pi) % (2 * np.pi) - np.pi


def rotate(vector: npt.ArrayLike, angle: npt.ArrayLike) -> FloatArray:
    """Turn `vector` (..., 2) counter-clockwise by `angle` (...) [rad]."""
    vector = np.asarray(vector, dtype=np.float64)
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


def direction(vector: npt.ArrayLike) -> FloatArray:
    """Return the heading of `vector` (..., 2) [rad]."""
    vector = np.asarray(vector, dtype=np.float64)
    return np.arctan2(vector[..., 1], vector[..., 0])
