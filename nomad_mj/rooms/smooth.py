"""Take the raggedness of measured maps out of their masks, by one cell at most."""

import numpy as np
from scipy import ndimage

from nomad_mj.rooms.rectangles import Mask

_LINE = np.array([[0, 0, 0], [1, 1, 1], [0, 0, 0]])
_SPECK = 4  # cells
_DEEP = 3  # cells that must lie behind a bump, or something thin would vanish with it


def without_specks(free: Mask, occupied: Mask) -> Mask:
    """Return what is free, with unknown spots of up to four cells in the midst of it too.

    Parameters
    ----------
    free, occupied : ndarray of bool, shape (R, C)
        All else is unknown.
    """
    labels = np.empty(free.shape, dtype=np.int32)
    ndimage.label(~free, np.ones((3, 3)), output=labels)
    small = np.bincount(labels.ravel()) <= _SPECK
    small[np.unique(labels[occupied])] = False
    return np.logical_or(free, small[labels])


def straighten(blocked: Mask) -> Mask:
    """Return a mask whose straight edges have lost their bumps and notches one cell deep.

    Only what sticks out of, or into, at least three cells more is taken for a bump or a notch, so
    that thin walls and narrow passages stay.

    Parameters
    ----------
    blocked : ndarray of bool, shape (R, C)

    Returns
    -------
    ndarray of bool, shape (R, C)
        It differs only in cells that have a side in common with cells of the other kind.
    """
    bumps = _all_around(blocked)
    straight = np.logical_and(blocked, ~bumps)
    return np.logical_or(straight, _all_around(~straight))


def _all_around(mask: Mask) -> Mask:
    """Return the bumps of a mask towards all four sides."""
    bumps = np.zeros_like(mask)
    for quarter in range(4):
        bumps |= np.rot90(_bumps(np.rot90(mask, quarter)), -quarter)
    return bumps


def _bumps(mask: Mask) -> Mask:
    """Return runs along rows that stick out one cell towards row 0, with a step down at an end."""
    rows = mask.shape[0] - 1 - _DEEP
    edge, step = np.zeros_like(mask), np.zeros_like(mask)
    if rows <= 0:
        return edge
    here, below = mask[1 : rows + 1], mask[2 : rows + 2]
    edge[1 : rows + 1] = here & ~mask[:rows]
    step[1 : rows + 1] = ~here & below
    for deeper in range(1, _DEEP + 1):
        edge[1 : rows + 1] &= mask[1 + deeper : rows + 1 + deeper]
    labels = np.empty(mask.shape, dtype=np.int32)
    ndimage.label(edge, _LINE, output=labels)
    beside = np.pad(step, ((0, 0), (1, 1)))
    ends = edge & (beside[:, :-2] | beside[:, 2:])
    return np.logical_and(edge, np.isin(labels, np.unique(labels[ends])))
