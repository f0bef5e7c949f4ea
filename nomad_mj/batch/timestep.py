"""What a step of many worlds returns: a `dm_env.TimeStep` whose parts are arrays."""

from collections import OrderedDict
from typing import Any, NamedTuple

import dm_env
import numpy as np
import numpy.typing as npt

from nomad_mj.types import FloatArray

FIRST, MID, LAST = (int(kind) for kind in dm_env.StepType)


class BatchTimeStep(NamedTuple):
    """One time step of each of N worlds.

    Attributes
    ----------
    step_type : array (N,) of int
        As `dm_env.StepType`.
    reward, discount : array (N,)
        NaN in the first time step of an episode, where dm_env has None.
    observation : OrderedDict
        As of the single environment, each array with N rows.
    """

    step_type: npt.NDArray[np.int64]
    reward: FloatArray
    discount: FloatArray
    observation: "OrderedDict[str, npt.NDArray[Any]]"

    def first(self) -> npt.NDArray[np.bool_]:
        """Return whose episode has just begun, (N,)."""
        return self.step_type == FIRST

    def mid(self) -> npt.NDArray[np.bool_]:
        """Return who is on the way, (N,)."""
        return self.step_type == MID

    def last(self) -> npt.NDArray[np.bool_]:
        """Return whose episode is over, (N,)."""
        return self.step_type == LAST

    def world(self, number: int) -> dm_env.TimeStep:
        """Return the time step of one world, as the single environment would."""
        kind = dm_env.StepType(int(self.step_type[number]))
        observation = OrderedDict((k, v[number].copy()) for k, v in self.observation.items())
        if kind == dm_env.StepType.FIRST:
            return dm_env.restart(observation)
        told = float(self.reward[number]), float(self.discount[number])
        return dm_env.TimeStep(kind, *told, observation)
