"""Coarse coding: signals and grids spread over overlapping receptive fields.

Sources: Eq 1 (semi-coarse coding of a signal) and Fig 4 (of the certainty grid) of the paper.
"""

from functools import lru_cache

import numpy as np
import numpy.typing as npt

from nomad_mj.perception.side_by_side import side_by_side
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


def coded_cells(cells: int) -> int:
    """Return how many receptive fields are along a side of a grid of so many cells."""
    for side, stride in GRID_FIELDS:
        cells = (cells - side) // stride + 1
    return cells


def code_grid(grid: FloatArray, threads: int = 1) -> FloatArray:
    """Return the grid twice coarse coded: (..., 21, 21) -> (..., 10, 10) -> (..., 4, 4).

    On so many `threads` hundreds of grids are coded side by side, to the same bits.
    """
    if threads == 1:
        for side, stride in GRID_FIELDS:
            grid = pool(grid, side, stride)
        return grid
    *lead, cells, _ = grid.shape
    grids = grid.reshape(-1, cells, cells)
    coded = np.empty((len(grids), coded_cells(cells), coded_cells(cells)))

    def code(part: slice) -> None:
        coded[part] = code_grid(grids[part])

    side_by_side(code, len(grids), threads)
    return coded.reshape(*lead, *coded.shape[1:])
