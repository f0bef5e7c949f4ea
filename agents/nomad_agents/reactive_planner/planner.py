"""The planner: one step ahead on the current certainty grid (section 3.1.1, Eqs 19-20)."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from nomad_agents.reactive_planner.config import PlannerConfig
from nomad_mj.motion import ActionSpec, displacement, reinforcement
from nomad_mj.perception import GridSpec, Percept, cell_centres
from nomad_mj.types import FloatArray

_AT_GOAL = 1e-9  # [m]
_STEPS = np.linspace(-1.0, 1.0, 9)
_ALL: FloatArray = np.stack(np.meshgrid(_STEPS, _STEPS, indexing="ij"), axis=-1).reshape(-1, 2)
# Without the null action: to stand still promises what standing here does, so the prediction comes
# true for ever and nothing is learnt.
ACTIONS: FloatArray = _ALL[_ALL.any(axis=1)]
ACTIONS.setflags(write=False)  # plans are rows of it


class Plan(NamedTuple):
    """The best of the 80 actions, (2,), and the cumulative reinforcement it promises."""

    action: FloatArray
    value: float


@lru_cache(maxsize=8)
def _centres(spec: GridSpec) -> FloatArray:
    return cell_centres(spec).reshape(-1, 2)


def estimate_value(
    places: FloatArray, percept: Percept, grid: GridSpec, config: PlannerConfig
) -> FloatArray:
    """Return the cumulative reinforcement that a place promises (Eq 19), as a number <= 0.

    Parameters
    ----------
    places : array (n, 2)
        From where `percept` was taken [m].
    percept : Percept
        Certainty grid and goal.
    grid, config
        Size of the grid; weights.

    Returns
    -------
    array (n,)
    """
    occupancy = percept.grid.ravel()
    seen = np.flatnonzero(occupancy > 0)
    to_cell = _centres(grid)[seen] - places[:, None]  # (n, cells, 2)
    to_goal = percept.goal - places  # (n, 2)
    cell_distance = np.hypot(to_cell[..., 0], to_cell[..., 1])
    goal_distance = np.hypot(to_goal[:, 0], to_goal[:, 1])
    along = to_cell[..., 0] * to_goal[:, :1] + to_cell[..., 1] * to_goal[:, 1:]
    between = along >= np.cos(config.k_alpha) * cell_distance * goal_distance[:, None]
    between &= goal_distance[:, None] > _AT_GOAL  # from the goal no direction leads to it
    repulsion = occupancy[seen] / np.maximum(cell_distance, config.k_clear)
    return -config.k_length * goal_distance - config.k_rep * (repulsion * between).sum(axis=1)


def path_clearance(
    moves: FloatArray, percept: Percept, radius: float, grid: GridSpec, config: PlannerConfig
) -> tuple[FloatArray, float]:
    """Return how near a robot of this radius comes to what the grid shows [m].

    Parameters
    ----------
    moves : array (n, 2)
        Displacements from where the percept was taken [m].
    percept, radius, grid, config
        The percept; of the robot [m]; size of the grid; from when a cell counts.

    Returns
    -------
    array (n,), float
        Along each move, and where the robot stands now; inf where the grid is empty.
    """
    cells = _centres(grid)[percept.grid.ravel() > config.occupied]
    if not len(cells):
        return np.full(len(moves), np.inf), np.inf
    length2 = np.maximum((moves**2).sum(axis=1), 1e-12)
    share = np.clip(moves @ cells.T / length2[:, None], 0.0, 1.0)  # (n, cells)
    x = cells[:, 0] - share * moves[:, :1]
    y = cells[:, 1] - share * moves[:, 1:]
    nearest = np.sqrt((x * x + y * y).min(axis=1))
    reach = radius + config.margin
    return nearest - reach, float(np.hypot(cells[:, 0], cells[:, 1]).min()) - reach


def plan(
    percept: Percept, radius: float, grid: GridSpec, action: ActionSpec, config: PlannerConfig
) -> Plan:
    """Return the best of the 80 actions.

    Actions that the grid shows to run into something are left out: their cost (at most 0.5) is
    less than what a metre costs, so that a literal reading of the paper drives into walls. Where
    all do, the one that keeps farthest off is taken.
    """
    moves = displacement(ACTIONS, percept.goal, action)
    clearance, now = path_clearance(moves, percept, radius, grid, config)
    value = reinforcement(moves, percept.goal, np.maximum(clearance, 0.0))
    value = value + estimate_value(moves, percept, grid, config)
    # Standing close to something bars no move that does not come closer still.
    barred = (clearance <= 0.0) & (clearance < now - 1e-9)
    best = int(np.argmax(clearance if barred.all() else np.where(barred, -np.inf, value)))
    return Plan(ACTIONS[best], float(value[best]))
