"""What the environments of many robots have in common: whose episode is over, and how to begin."""

from abc import ABC, abstractmethod
from collections import OrderedDict
from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
from dm_env import specs
from typing_extensions import Self

from nomad_mj.batch.specs import stacked
from nomad_mj.batch.timestep import FIRST, LAST, MID, BatchTimeStep
from nomad_mj.batch.worlds import Mask, Seed, Worlds
from nomad_mj.errors import ConfigError
from nomad_mj.scene import Scene
from nomad_mj.tasks import MotorTask, Start
from nomad_mj.types import FloatArray, IntArray

BoolArray: TypeAlias = "npt.NDArray[np.bool_]"


class BatchEnvironment(ABC):
    """N environments of one robot in one process, in the manner of `dm_env`.

    World by world all is the same to the bit as in the single environment with the same seed,
    whatever the number of threads and whatever the other worlds do.

    Parameters
    ----------
    worlds : Worlds
        The robots and their rooms.
    time_limit : float
        Length of an episode [s of simulated time]; its end is a truncation, discount 1.
    """

    def __init__(self, worlds: Worlds, time_limit: float) -> None:
        if not time_limit > 0:
            raise ConfigError(f"time limit {time_limit}: must be above 0 s")
        self.worlds = worlds
        self._time_limit, self._closed = time_limit, False
        self._type = np.full(worlds.count, LAST, dtype=np.int64)
        self._reward, self._discount = np.full((2, worlds.count), np.nan)

    @property
    def count(self) -> int:
        """Number of worlds N."""
        return self.worlds.count

    @property
    def tasks(self) -> "tuple[MotorTask, ...]":
        """The motor task of each world: its scene, its true start, what moves in it."""
        return tuple(self.worlds.tasks)

    @property
    def scenes(self) -> "tuple[Scene, ...]":
        """The robot and the room of each world."""
        return tuple(task.scene for task in self.worlds.tasks)

    @abstractmethod
    def action_spec(self) -> specs.BoundedArray:
        """Return the shape and limits of actions, with N rows."""

    @abstractmethod
    def single_observation_spec(self) -> "OrderedDict[str, specs.Array]":
        """Return the shapes and limits of one world's observations."""

    def observation_spec(self) -> "OrderedDict[str, specs.Array]":
        """Return the shapes and limits of the observations, with N rows."""
        single = self.single_observation_spec()
        return OrderedDict((name, stacked(spec, self.count)) for name, spec in single.items())

    @abstractmethod
    def _observe(self) -> "OrderedDict[str, npt.NDArray[Any]]":
        """Return the observations of all worlds, copied."""

    @abstractmethod
    def _begun(self, chosen: IntArray) -> None:
        """Do what else is to be done when episodes of worlds (n,) have begun."""

    def reset(
        self,
        seed: "Seed | Sequence[Seed]" = None,
        starts: "Sequence[Start] | None" = None,
        mask: Mask = None,
    ) -> BatchTimeStep:
        """Begin new episodes.

        Parameters
        ----------
        seed : int, SeedSequence or sequence of length N, optional
            Start the sequences of episodes anew: a whole number s gives world i the seed s + i, as
            Gymnasium's vector environments do, a SeedSequence its child i; or one seed for each
            world, None for one that goes on with its present sequence.
        starts : sequence of length N, optional
            A start for each world, as of `MotorEnvironment.reset`; None for any.
        mask : sequence of bool, length N, optional
            Which worlds; the others stay as they are. None for all.

        Raises
        ------
        StartError
            A start that cannot be, naming the world; nothing has been reset then. Or what moves in
            a world has found no place: then other episodes begin in all of these at the next step.
        RuntimeError
            The environment has been closed.
        """
        self._refuse_closed()
        chosen = self.worlds.chosen(mask)
        seeds = self.worlds.seeds(seed)
        if starts is not None:
            self.worlds.start_at(starts, chosen)
        self.worlds.seed(seeds, chosen)
        self._begin(chosen)
        return self.time_step()

    def _begin(self, chosen: IntArray) -> None:
        """Begin an episode in each of some worlds (n,)."""
        self._type[chosen] = LAST  # should it fail, these begin at the next step
        self.worlds.reset(chosen)
        self._type[chosen] = FIRST
        self._reward[chosen] = self._discount[chosen] = np.nan
        self._begun(chosen)

    def _tell(
        self, worlds: IntArray, rewards: list[float], ended: BoolArray, elapsed: BoolArray
    ) -> None:
        """Note how steps of worlds (n,) went: rewards, who is at the goal, who out of time."""
        self._type[worlds] = np.where(ended | elapsed, LAST, MID)
        self._reward[worlds] = rewards
        self._discount[worlds] = np.where(ended, 0.0, 1.0)

    def time_step(self) -> BatchTimeStep:
        """Return the present time step of every world, copied."""
        self._refuse_closed()
        return BatchTimeStep(
            self._type.copy(), self._reward.copy(), self._discount.copy(), self._observe()
        )

    def _check_actions(self, actions: Any, size: int) -> FloatArray:
        """Return the actions as an array (N, size)."""
        self._refuse_closed()
        given = np.asarray(actions, dtype=np.float64)
        if given.shape != (self.count, size):
            raise ValueError(
                f"actions of shape {given.shape}: must be {(self.count, size)}, one row a world"
            )
        return given

    def _refuse_closed(self) -> None:
        if self._closed:
            raise RuntimeError("the environment has been closed: load another one")

    def close(self) -> None:
        """Free all simulations; they cannot be used any more."""
        self._closed = True
        self.worlds.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
