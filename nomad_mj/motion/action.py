"""What an action means: a move in the frame of the shortest path vector (Eqs 3-5)."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from nomad_mj.errors import ConfigError
from nomad_mj.geometry import direction, rotate
from nomad_mj.option_types import check_fields
from nomad_mj.types import FloatArray


@dataclass(frozen=True)
class ActionSpec:
    """How long a move can be.

    Attributes
    ----------
    longest : float
        Half the perception range [m]: no move is longer (Eq 5).
    shortest : float
        step_eps of Table 1 [m]: no move is shorter (Eq 3).
    """

    longest: float = 1.0
    shortest: float = 0.01

    def __post_init__(self) -> None:
        check_fields(self)
        if not 0 < self.shortest <= self.longest < np.inf:
            raise ConfigError(
                f"moves of {self.shortest} to {self.longest} m: must be above 0, the shortest first"
            )


def displacement(action: npt.ArrayLike, goal: FloatArray, spec: ActionSpec) -> FloatArray:
    """Return the move that an action asks for.

    Parameters
    ----------
    action : array (..., 2)
        (dx, dy) in [-1, 1]; positive dx leads to the goal, positive dy to the left of it.
    goal : array (..., 2)
        Shortest path vector: from the robot to the goal, world orientation [m].
    spec : ActionSpec
        Limits of a move.

    Returns
    -------
    array (..., 2)
        Displacement in the world's orientation [m]. The null action goes towards the goal.
    """
    action = np.asarray(action, dtype=np.float64)
    size = np.hypot(action[..., 0], action[..., 1])
    radius = np.minimum(spec.longest, np.hypot(goal[..., 0], goal[..., 1]))
    length = np.maximum(np.minimum(size, 1.0) * radius, spec.shortest)
    heading = np.where(size > 0, direction(action), 0.0) + direction(goal)
    return rotate(np.stack([length, np.zeros_like(length)], axis=-1), heading)
