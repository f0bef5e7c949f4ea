"""Coarse coding: signals and grids spread over overlapping receptive fields.

Sources: Eq 1 (semi-coarse coding of a signal) and Fig 4 (of the certainty grid) of the paper.
"""

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from nomad_mj.types import FloatArray

UNIT_CENTRES: FloatArray = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
GRID_FIELDS = ((3, 2), (4, 2))  # (side, stride) of the receptive fields: 21 -> 10 -> 4
FEWEST_CELLS = 9  # along a side, for one field of each


def code_signal(signal: npt.ArrayLike, width: float, *, circular: bool = False) -> FloatArray:
    """Return the activity of five units with localised receptive fields (Eq 1).

    Parameters
    ----------
    signal : array (...)
        Values in [0, 1].
    width : float
        Half the width of a receptive field.
    circular : bool
        Whether 0 and 1 are the same point, as for a direction.

    Returns
    -------
    array (..., 5)
        In [0, 1].
    """
    off = np.asarray(signal, dtype=np.float64)[..., None] - UNIT_CENTRES
    if circular:
        off = (off + 0.5) % 1.0 - 0.5
    return np.maximum(1.0 - (off / width) ** 2, 0.0)


@lru_cache(maxsize=16)
def _pooling(cells: int, side: int, stride: int) -> FloatArray:
    """Return the matrix (fields, cells) that averages `side` neighbours every `stride`."""
    fields = (cells - side) // stride + 1
    start = np.arange(fields)[:, None] * stride
    cell = np.arange(cells)
    return ((cell >= start) & (cell < start + side)) / side


def pool(grid: FloatArray, side: int, stride: int) -> FloatArray:
    """Return the means over overlapping squares of `side` cells: (..., n, n) -> (..., m, m)."""
    matrix = _pooling(grid.shape[-1], side, stride)
    return matrix @ grid @ matrix.T


def code_grid(grid: FloatArray) -> FloatArray:
    """Return the grid twice coarse coded: (..., 21, 21) -> (..., 10, 10) -> (..., 4, 4)."""
    for side, stride in GRID_FIELDS:
        grid = pool(grid, side, stride)
    return grid
