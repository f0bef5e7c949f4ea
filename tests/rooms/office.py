"""A map such as a robot measures: for the tests of large maps, and to time them."""

import numpy as np
from scipy import ndimage

from nomad_mj.rooms import FREE, OCCUPIED, UNKNOWN, Occupancy

RESOLUTION = 0.05  # [m] a cell


def office(cells: int = 400, noise: float = 0.02) -> Occupancy:
    """Return offices along corridors, with a table and a cupboard each.

    Walls are ragged by a cell and some cells unknown, unless the noise is zero.
    """
    rng = np.random.default_rng(0)
    grid = np.full((cells, cells), FREE, dtype=np.uint8)
    rows, columns = np.indices(grid.shape)
    for y in range(0, cells, 100):
        grid[y : y + 3] = grid[y + 70 : y + 73] = OCCUPIED
        grid[y + 70 : y + 73, 20::80] = grid[y + 70 : y + 73, 21::80] = OCCUPIED
        for x in range(0, cells, 80):
            grid[y : y + 70, x : x + 4] = OCCUPIED
            grid[y + 70 : y + 73, x + 40 : x + 60] = FREE
            grid[y : y + 3, x + 40 : x + 60] = FREE if y else OCCUPIED
            here = np.s_[y + 20 : y + 40, x + 10 : x + 30]
            grid[here][np.hypot(rows[here] - y - 30, columns[here] - x - 20) < 8] = OCCUPIED
            grid[y + 30 : y + 45, x + 50 : x + 64] = OCCUPIED
    grid[-3:] = grid[:, -3:] = OCCUPIED
    edge = ndimage.binary_dilation(grid == OCCUPIED) & (grid == FREE)
    if noise:
        grid[edge & (ndimage.uniform_filter(rng.random(grid.shape), 7) > 0.55)] = OCCUPIED
    grid[(rng.random(grid.shape) < noise / 40) & (grid == FREE)] = UNKNOWN
    return Occupancy(grid, RESOLUTION)
