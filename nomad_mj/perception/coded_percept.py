"""What a network is shown of a percept: numbers in [0, 1] or [-1, 1], as float32."""

from typing import Literal, TypeAlias, get_args

import numpy as np
import numpy.typing as npt

from nomad_mj.geometry import direction
from nomad_mj.perception.situation import Percept
from nomad_mj.types import FloatArray, SensorLayout

Observation = Literal["situation", "ranges"]
OBSERVATIONS: tuple[Observation, ...] = get_args(Observation)
Float32Array: TypeAlias = npt.NDArray[np.float32]
DISTANCE_SCALE = 5.0  # [m] at which the distance to the goal reads 1/e


def code_percept(percept: Percept, layout: SensorLayout, observation: Observation) -> Float32Array:
    """Return a percept as a network is shown it.

    Parameters
    ----------
    percept : Percept
        What is perceived at one place, or at many.
    layout : SensorLayout
        The robot's sensors.
    observation : "situation" or "ranges"
        Which of the two codings.

    Returns
    -------
    array (..., 26) or (..., layout.count + 3)
        The situation as it is, or what `code_ranges` returns.
    """
    if observation == "situation":
        return percept.situation.astype(np.float32)
    return code_ranges(percept.ranges, percept.sensors, percept.goal, layout)


def code_ranges(
    ranges: FloatArray, sensors: FloatArray | float, goal: FloatArray, layout: SensorLayout
) -> Float32Array:
    """Return readings and the goal as the frame of the sensors has them.

    Parameters
    ----------
    ranges : array (..., layout.count)
        Readings of all rings, concatenated [m].
    sensors : array (...)
        Direction of the sensors' frame [rad].
    goal : array (..., 2)
        From the robot to the goal, world orientation [m].
    layout : SensorLayout
        The robot's sensors.

    Returns
    -------
    array (..., layout.count + 3)
        All readings as a share of their maximum; cosine and sine of the goal's direction in the
        frame of the sensors; exp(-distance / 5 m) to the goal.
    """
    longest = np.concatenate([np.full(len(r.bearings), r.max_range) for r in layout.rings])
    turn = direction(goal) - sensors
    near = np.exp(-np.hypot(goal[..., 0], goal[..., 1]) / DISTANCE_SCALE)
    where = np.stack([np.cos(turn), np.sin(turn), near], axis=-1)
    return np.concatenate([ranges / longest, where], axis=-1).astype(np.float32)


def coded_size(layout: SensorLayout, observation: Observation, situation: int) -> int:
    """Return how many numbers a network is shown; `situation` is that of `SituationSpec.size`."""
    return situation if observation == "situation" else layout.count + 3
