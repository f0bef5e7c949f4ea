"""The motor task of many robots."""

from collections import OrderedDict
from typing import Any

import numpy as np
import numpy.typing as npt
from dm_control.rl.control import FLAT_OBSERVATION_KEY
from dm_env import specs

from nomad_mj.batch.environment import BatchEnvironment
from nomad_mj.batch.specs import stacked_bounded
from nomad_mj.batch.timestep import LAST, BatchTimeStep
from nomad_mj.batch.worlds import Mask, Worlds
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.types import IntArray


class BatchMotor(BatchEnvironment):
    """Many `MotorEnvironment` side by side: motor velocities at 20 Hz, (N, M).

    A world whose episode is over begins another one in its next step, whatever its action is.

    Parameters
    ----------
    worlds : Worlds
        The robots and their rooms.
    time_limit : float
        Length of an episode [s of simulated time]; its end is a truncation, discount 1.
    flat_observation : bool
        Concatenate all observations into one array, (N, ...).
    """

    def __init__(
        self, worlds: Worlds, time_limit: float = 120.0, flat_observation: bool = False
    ) -> None:
        super().__init__(worlds, time_limit)
        self._flat = flat_observation
        self._motors = len(worlds.tasks[0].scene.robot.drive.motors)
        self._steps = np.zeros(worlds.count, dtype=np.intp)
        timestep = worlds.tasks[0].scene.model.opt.timestep
        self._most = time_limit / (timestep * round(CONTROL_TIMESTEP / timestep))

    def action_spec(self) -> specs.BoundedArray:
        """Return the motors' limits, (N, M)."""
        return stacked_bounded(self.tasks[0].motor_spec(), self.count)

    def single_observation_spec(self) -> "OrderedDict[str, specs.Array]":
        """Return the shapes and limits of one world's observations; flat ones have no limits."""
        spec = self.tasks[0].sensor_spec()
        if self._flat:
            size = sum(int(np.prod(part.shape)) for part in spec.values())
            whole = specs.Array((size,), np.float64, name=FLAT_OBSERVATION_KEY)
            return OrderedDict[str, specs.Array]([(FLAT_OBSERVATION_KEY, whole)])
        return spec

    def step(self, actions: npt.ArrayLike, mask: Mask = None) -> BatchTimeStep:
        """Advance worlds by a control step.

        Parameters
        ----------
        actions : array_like (N, M)
            Motor commands, in the order of the drive's.
        mask : sequence of bool, length N, optional
            Which worlds; the others wait, and their last time step is told again. None for all.

        Raises
        ------
        PhysicsError
            A simulation diverged, naming the worlds. All that were to be stepped begin a new
            episode at their next step.
        """
        chosen = self.worlds.chosen(mask)
        given = self._check_actions(actions, self._motors)
        over = self._type[chosen] == LAST
        going = chosen[~over]
        if over.any():
            self._begin(chosen[over])
        self._type[going] = LAST  # should it fail
        self.worlds.step(going, given[going])
        self._steps[going] += 1
        distances, task = self.worlds.goal_distances(going), self.worlds.tasks[0]
        elapsed = self._steps[going] >= self._most
        ended = np.array([task.ends_at(distance) for distance in distances], dtype=bool)
        # dm_control looks at the clock first.
        self._tell(going, [task.reward_at(d) for d in distances], ended & ~elapsed, elapsed)
        return self.time_step()

    def _begun(self, chosen: IntArray) -> None:
        self._steps[chosen] = 0

    def _observe(self) -> "OrderedDict[str, npt.NDArray[Any]]":
        told = self.worlds.observe()
        if not self._flat:
            return told
        return OrderedDict([(FLAT_OBSERVATION_KEY, np.concatenate(list(told.values()), axis=1))])
