"""The reinforcement signal: what a move cost (Eqs 6-8)."""

import numpy as np
import numpy.typing as npt

from nomad_mj.geometry import direction, wrap_angle
from nomad_mj.types import FloatArray

SAFE_CLEARANCE = 0.1  # k_clear of Table 1 [m]


def reinforcement(
    move: FloatArray, goal: FloatArray, clearance: npt.ArrayLike, collided: npt.ArrayLike = False
) -> FloatArray:
    """Return z in [-1, 0], for moves of 1 m at most.

    Parameters
    ----------
    move : array (..., 2)
        Planned displacement [m]; its length is the actual_length of Eq 3.
    goal : array (..., 2)
        Shortest path vector before the move, same orientation [m].
    clearance : array (...)
        Shortest reading of any range sensor during the move [m] (Eq 7).
    collided : array of bool (...)
        Whether a virtual collision or a contact ended the move: counts as no clearance at all.
        With the small cost of Eq 7 alone nothing would be learnt from it.
    """
    near = np.minimum(np.asarray(clearance, dtype=np.float64) / SAFE_CLEARANCE, 1.0) - 1.0
    near = np.where(collided, -1.0, np.maximum(near, -1.0))
    angle = np.abs(wrap_angle(direction(move) - direction(goal)))
    detour = -np.hypot(move[..., 0], move[..., 1]) * angle / np.pi
    return (near + detour) / 2
