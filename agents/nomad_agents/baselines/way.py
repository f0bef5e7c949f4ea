"""How far a disc gets on the certainty grid: what the classical agents have in common.

The robot is a disc and a cell that is likely occupied is the point at its centre, so a move is free
until the disc, grown by a safety distance, would touch such a point.
"""

from functools import lru_cache

import numpy as np

from nomad_mj.geometry import direction, wrap_angle
from nomad_mj.motion import ActionSpec
from nomad_mj.perception import GridSpec, Percept, cell_centres
from nomad_mj.types import FloatArray, SensorLayout

_AT_GOAL = 1e-9  # [m]
_TIGHT = 0.9  # of the distance to a cell that the robot stands closer to than it should


@lru_cache(maxsize=8)
def centres(spec: GridSpec) -> FloatArray:
    """Return the cells' centres (cells**2, 2) [m], from the robot; not to be written to."""
    result = cell_centres(spec).reshape(-1, 2)
    result.setflags(write=False)
    return result


def occupied_cells(percept: Percept, grid: GridSpec, occupied: float) -> FloatArray:
    """Return the centres (n, 2) of the cells above this probability [m], from the robot."""
    return centres(grid)[percept.grid.ravel() > occupied]


def reach_of(layout: SensorLayout, safety: float) -> float:
    """Return how far from a robot's centre things are to stay [m].

    Where sensors see nothing nearer than some distance path finding stops the robot there. Where
    that is farthest decides for all directions.
    """
    return layout.radius + safety + float(layout.least_readings.max())


def free_way(headings: FloatArray, cells: FloatArray, reach: float) -> FloatArray:
    """Return how far a disc can go in each direction [m], inf where nothing is in the way.

    Parameters
    ----------
    headings : array (n,)
        Directions [rad].
    cells : array (m, 2)
        Points to keep off [m], from the disc's centre.
    reach : float
        Radius of the disc with its safety distance [m]. Where it stands closer than that to a
        point, it can leave it or pass along, but not come nearer than nine tenths: that is no way.

    Returns
    -------
    array (n,)
    """
    if not len(cells):
        return np.full(len(headings), np.inf)
    square = cells[:, 0] ** 2 + cells[:, 1] ** 2
    within = square < reach * reach  # of these alone: one behind leaves no room ahead
    radius2 = np.where(within, _TIGHT * _TIGHT * square, reach * reach)
    ahead = np.cos(headings)[:, None] * cells[:, 0] + np.sin(headings)[:, None] * cells[:, 1]
    half = radius2 - square + ahead * ahead  # squared half chord of the disc about the point
    hit = (half > 0) & (ahead > 0)
    way = np.where(within, 0.0, ahead - np.sqrt(np.maximum(half, 0.0)))
    return np.where(hit, way, np.inf).min(axis=1)


def action_towards(heading: float, length: float, goal: FloatArray, spec: ActionSpec) -> FloatArray:
    """Return the action (2,) that means a move: the inverse of `displacement`.

    Parameters
    ----------
    heading, length : float
        Of the move in the world's orientation [rad], [m]; longer ones than can be are cut.
    goal : array (2,)
        From the robot to the goal, world orientation [m].
    spec : ActionSpec
        Limits of a move.
    """
    longest = longest_move(goal, spec)
    size = min(length / longest, 1.0) if longest > _AT_GOAL else 1.0
    turn = float(wrap_angle(heading - direction(goal)))
    return size * np.array([np.cos(turn), np.sin(turn)])


def longest_move(goal: FloatArray, spec: ActionSpec) -> float:
    """Return how long a move can be here [m]: none goes farther than the goal is."""
    return min(spec.longest, float(np.hypot(goal[0], goal[1])))
