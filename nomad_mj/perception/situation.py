"""The situation: the 26 numbers in [0, 1] that the controller acts upon (section 2.1)."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from nomad_mj.errors import ConfigError
from nomad_mj.geometry import direction
from nomad_mj.limits import MOST, TINY, require
from nomad_mj.perception.certainty_grid import GridSpec, certainty_grid
from nomad_mj.perception.coarse_coding import (
    FEWEST_CELLS,
    UNIT_CENTRES,
    code_grid,
    code_signal,
    coded_cells,
)
from nomad_mj.types import FloatArray, SensorLayout


@dataclass(frozen=True)
class SituationSpec:
    """How the attraction force and the certainty grid become a situation.

    Attributes
    ----------
    width : float
        w of Eq 1: half the width of the receptive fields of the attraction force.
    circular : bool
        Code the direction on the circle instead of on the segment [0, 1].
    intensity_scale : float
        Distance [m] at which the attraction has fallen to 1/e.
    use_intensity : bool
        Whether the distance to the goal is part of the situation (Fig 14: not).
    grid : GridSpec
        The certainty grid.
    """

    width: float = 0.35
    circular: bool = False
    intensity_scale: float = 5.0
    use_intensity: bool = True
    grid: GridSpec = field(default_factory=GridSpec)

    def __post_init__(self) -> None:
        require(self, width=(TINY, MOST), intensity_scale=(TINY, MOST))
        if self.grid.cells < FEWEST_CELLS:
            raise ConfigError(f"cells {self.grid.cells}: must be {FEWEST_CELLS} or more")

    @property
    def size(self) -> int:
        """Number of components of a situation."""
        return 2 * len(UNIT_CENTRES) + coded_cells(self.grid.cells) ** 2


class Percept(NamedTuple):
    """What the controller perceives at one place.

    Attributes
    ----------
    situation : array (..., 26)
        Direction (5), intensity (5) and coarse grid (16), all in [0, 1].
    grid : array (..., 21, 21)
        The certainty grid; rows along y, oriented as the world.
    goal : array (..., 2)
        Shortest path vector: from the robot to the goal in the world's orientation [m].
    ranges : array (..., C)
        The readings it was made from, all rings concatenated [m].
    sensors : array (...)
        Direction of the sensors' frame [rad].
    """

    situation: FloatArray
    grid: FloatArray
    goal: FloatArray
    ranges: FloatArray = np.zeros(0)
    sensors: FloatArray | float = 0.0


def attraction_force(goal: FloatArray, spec: SituationSpec) -> FloatArray:
    """Return the coded attraction force (..., 10) of the vector `goal` (..., 2) [m]."""
    turn = (direction(goal) / (2 * np.pi)) % 1.0
    distance = np.hypot(goal[..., 0], goal[..., 1])
    intensity = code_signal(np.exp(-distance / spec.intensity_scale), spec.width)
    if not spec.use_intensity:
        intensity = np.zeros_like(intensity)
    return np.concatenate(
        [code_signal(turn, spec.width, circular=spec.circular), intensity], axis=-1
    )


def perceive(
    ranges: FloatArray,
    heading: FloatArray | float,
    goal: FloatArray,
    layout: SensorLayout,
    spec: SituationSpec,
    threads: int = 1,
) -> Percept:
    """Return the percept of one round of readings, of one robot or of many.

    Parameters
    ----------
    ranges : array (..., layout.count)
        Readings of all rings, concatenated [m].
    heading : array (...)
        Direction of the sensors' frame [rad].
    goal : array (..., 2)
        From the robot to the goal, world orientation [m].
    layout, spec
        The robot's sensors and the coding.
    threads : int
        For hundreds of robots, as of `certainty_grid`.
    """
    grid = certainty_grid(ranges, heading, layout, spec.grid, threads)
    coarse = code_grid(grid, threads).reshape(*grid.shape[:-2], -1)
    situation = np.concatenate([attraction_force(goal, spec), coarse], axis=-1)
    return Percept(situation, grid, goal, ranges, heading)
