"""Cells of a grid as few rectangles."""

import numpy as np
import numpy.typing as npt

from nomad_mj.types import IntArray

Mask = npt.NDArray[np.bool_]


def merge_cells(must: Mask, may: Mask | None = None) -> IntArray:
    """Cover cells of a grid by rectangles that do not overlap.

    Greedy, from the first cell on that is not covered: of the rectangle that grows along the row
    first and that which grows along the column first, the one that covers more.

    Parameters
    ----------
    must : ndarray of bool, shape (R, C)
        Every one of these cells is covered, once.
    may : ndarray of bool, shape (R, C), optional
        Cells that may be covered too where that saves rectangles. Without it the rectangles
        cover `must` exactly.

    Returns
    -------
    ndarray of int, shape (N, 4)
        Half-open ranges ``row0, column0, row1, column1``, in the order of their first cells.
    """
    todo = must.copy()
    allowed = must.copy() if may is None else must | may
    found: list[tuple[int, int, int, int]] = []
    for row, column in np.argwhere(must):
        if todo[row, column]:
            found.append(_grow(todo, allowed, int(row), int(column)))
            row0, column0, row1, column1 = found[-1]
            todo[row0:row1, column0:column1] = False
            allowed[row0:row1, column0:column1] = False
    return np.array(found, dtype=np.intp).reshape(-1, 4)


def _grow(todo: Mask, allowed: Mask, row: int, column: int) -> tuple[int, int, int, int]:
    """Return the better of two rectangles that begin at a cell, cut to what is still to do."""
    here = allowed[row:, column:]
    wide = _run(here[0])
    deep = _run(np.asarray(here[:, :wide].all(axis=1)))
    along_row = todo[row : row + deep, column : column + wide]
    tall = _run(here[:, 0])
    broad = _run(np.asarray(here[:tall].all(axis=0)))
    along_column = todo[row : row + tall, column : column + broad]
    best = along_row if along_row.sum() >= along_column.sum() else along_column
    rows = np.flatnonzero(best.any(axis=1))
    columns = np.flatnonzero(best.any(axis=0))
    return row, column + int(columns[0]), row + int(rows[-1]) + 1, column + int(columns[-1]) + 1


def _run(line: Mask) -> int:
    """Count the cells that are true from the first on."""
    return len(line) if line.all() else int(line.argmin())
