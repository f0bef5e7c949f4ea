"""Cells of a grid as few rectangles."""

from bisect import bisect_left
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from nomad_mj.types import IntArray

Mask = npt.NDArray[np.bool_]
_Rectangle = tuple[int, int, int, int]


def merge_cells(must: Mask, may: Mask | None = None) -> IntArray:
    """Cover cells of a grid by rectangles, which may overlap.

    Greedy, from the first cell on that is not covered: of the rectangle that grows along the row
    first and that which grows along the column first, the one that newly covers more.

    Parameters
    ----------
    must : ndarray of bool, shape (R, C)
        Every one of these cells is covered.
    may : ndarray of bool, shape (R, C), optional
        Cells that may be covered too where that saves rectangles. Without it the rectangles
        cover `must` and nothing else.

    Returns
    -------
    ndarray of int, shape (N, 4)
        Half-open ranges ``row0, column0, row1, column1``, in the order of the cells that they
        were grown from.
    """
    todo = must.copy()
    allowed = must if may is None else must | may
    totals = np.pad(allowed.cumsum(axis=0, dtype=np.int64).cumsum(axis=1), ((1, 0), (1, 0)))

    def is_full(row0: int, column0: int, row1: int, column1: int) -> bool:
        inside = totals[row1, column1] - totals[row0, column1]
        inside += totals[row0, column0] - totals[row1, column0]
        return bool(inside == (row1 - row0) * (column1 - column0))

    found: list[_Rectangle] = []
    for row, column in np.argwhere(must).tolist():
        if todo[row, column]:
            grown = _grow(is_full, todo.shape, row, column)
            best = max(grown, key=lambda each: int(_part(todo, each).sum()))
            found.append(_cut(todo, best))
            _part(todo, best)[:] = False
    return np.array(found, dtype=np.intp).reshape(-1, 4)


def _part(mask: Mask, rectangle: _Rectangle) -> Mask:
    row0, column0, row1, column1 = rectangle
    return mask[row0:row1, column0:column1]


def _grow(
    is_full: Callable[[int, int, int, int], bool], shape: tuple[int, ...], row: int, column: int
) -> tuple[_Rectangle, _Rectangle]:
    """Return two rectangles around a cell that cannot grow: along the row first, and not."""
    grown: list[_Rectangle] = []
    for order in ((1, 3, 0, 2), (0, 2, 1, 3)):
        edges = [row, column, row + 1, column + 1]
        for edge in order:
            _push(is_full, edges, edge, 0 if edge < 2 else shape[edge - 2])
        grown.append((edges[0], edges[1], edges[2], edges[3]))
    return grown[0], grown[1]


def _push(
    is_full: Callable[[int, int, int, int], bool], edges: list[int], edge: int, last: int
) -> None:
    """Move one edge of a rectangle as far out as all in it is allowed."""
    start, sign = edges[edge], -1 if edge < 2 else 1

    def stops(step: int) -> bool:
        edges[edge] = start + sign * step
        return not is_full(*edges)

    steps = bisect_left(range(1, abs(last - start) + 1), True, key=stops)
    edges[edge] = start + sign * steps


def _cut(todo: Mask, rectangle: _Rectangle) -> _Rectangle:
    """Return the part of a rectangle in which something is still to do."""
    row0, column0, _, _ = rectangle
    left = _part(todo, rectangle)
    rows, columns = np.flatnonzero(left.any(axis=1)), np.flatnonzero(left.any(axis=0))
    first, last = (int(rows[0]), int(columns[0])), (int(rows[-1]), int(columns[-1]))
    return row0 + first[0], column0 + first[1], row0 + last[0] + 1, column0 + last[1] + 1
