"""Gymnasium's vector environments on `nomad_mj.batch`: many robots in one process."""

from collections.abc import Sequence
from typing import Any, cast

import numpy as np
import numpy.typing as npt
from dm_control.rl.control import PhysicsError
from gymnasium import spaces
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.utils.seeding import np_random
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space, concatenate, create_empty_array

from nomad_mj.batch import BatchMotor, BatchPathFinding, BatchTimeStep
from nomad_mj.errors import ConfigError
from nomad_mj.gym.account import Account
from nomad_mj.types import FloatArray

_OPTIONS = ("reset_mask", "start", "starts")
Told = tuple[Any, float, bool, bool, dict[str, Any]]
Bools = npt.NDArray[np.bool_]


class NavigationVectorEnv(VectorEnv[Any, Any, Any]):
    """N environments stepped together; each is to the bit the single one with its seed.

    A seed s for all gives environment i the seed s + i. Whose episode is over begins another one
    as `autoreset_mode` says: in the next step, which ignores its action (Gymnasium's default); in
    the same step, with ``final_obs`` and ``final_info`` in the infos; or when it is told to.

    Parameters
    ----------
    batch : BatchPathFinding or BatchMotor
        The environments below; closing this one closes it.
    accounts : sequence of Account, length N
        One for each world.
    observation_space, action_space : Space
        Of a single environment.
    autoreset_mode : AutoresetMode or str
        When new episodes begin.
    max_episode_steps : int, optional
        After so many steps an episode is truncated.
    """

    def __init__(
        self,
        batch: BatchPathFinding | BatchMotor,
        accounts: Sequence[Account],
        observation_space: spaces.Space[Any],
        action_space: spaces.Box,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        max_episode_steps: int | None = None,
    ) -> None:
        self.autoreset_mode = _mode(autoreset_mode)
        self.metadata = {"render_modes": [], "autoreset_mode": self.autoreset_mode}
        self.batch, self._accounts = batch, accounts
        self.num_envs = batch.count
        self.single_observation_space, self.single_action_space = observation_space, action_space
        self.observation_space = batch_space(observation_space, batch.count)
        self.action_space = batch_space(action_space, batch.count)
        if max_episode_steps is not None and max_episode_steps < 1:
            raise ConfigError(f"max episode steps {max_episode_steps}: must be 1 or more")
        self._limit = np.inf if max_episode_steps is None else max_episode_steps
        self._steps = np.zeros(batch.count, dtype=np.intp)
        self._observed: list[Any] = [None] * batch.count
        self._rewards = np.zeros(batch.count)
        self._terminated, self._truncated = np.zeros((2, batch.count), dtype=bool)
        self._begun = np.zeros(batch.count, dtype=bool)

    def reset(
        self,
        *,
        seed: "int | Sequence[int | None] | None" = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Any, dict[str, Any]]:
        """Begin new episodes.

        Parameters
        ----------
        seed : int or sequence of int, optional
            One for all, s, gives environment i the seed s + i.
        options : dict, optional
            ``reset_mask``, array of N bool: which environments; the others stay as they are.
            ``start``: one for all, as of the single environment. ``starts``: one for each.

        Raises
        ------
        StartError, ConfigError
            A start that cannot be, another option.
        ClosedEnvironmentError
            The environments have been closed.
        """
        self._refuse_closed()
        given = options or {}
        for name in given:
            if name not in _OPTIONS:
                known = ", ".join(_OPTIONS)
                raise ConfigError(f"unknown reset option {name!r}; there are: {known}")
        mask = given.get("reset_mask")
        starts = given.get("starts")
        if given.get("start") is not None:
            starts = [given["start"]] * self.num_envs
        chosen = np.ones(self.num_envs, dtype=bool) if mask is None else np.asarray(mask)
        if chosen.shape == self._begun.shape and not (chosen | self._begun).all():
            raise ConfigError("reset_mask: leaves out an environment that has not begun yet")
        step = self.batch.reset(seed, starts, chosen)
        first = seed[0] if isinstance(seed, Sequence | np.ndarray) else seed
        if first is not None:  # of what wrappers draw; the environments have their own
            self._np_random, self._np_random_seed = np_random(int(first))
        infos: dict[str, Any] = {}
        self._begin(step, chosen, infos)
        return self._stacked(), infos

    def _begin(self, step: BatchTimeStep, chosen: Bools, infos: dict[str, Any]) -> None:
        """Take in the first time steps of those chosen."""
        self._begun |= chosen
        self._steps[chosen] = 0
        self._rewards[chosen] = 0.0
        self._terminated[chosen] = self._truncated[chosen] = False
        for env in np.flatnonzero(chosen).tolist():
            self._observed[env], info = self._accounts[env].begin(step.world(env))
            self._add_info(infos, info, env)

    def step(self, actions: Any) -> tuple[Any, FloatArray, Bools, Bools, dict[str, Any]]:
        """Act; return observations, rewards, terminations, truncations, infos.

        Parameters
        ----------
        actions : array (N, A)
            In [-1, 1]; what lies outside is clipped.

        Raises
        ------
        ResetNeeded
            An episode is over, or none has begun.
        ValueError
            Actions of another shape, or with numbers that are not finite.
        PhysicsError
            A simulation diverged: the episodes are over, all that were not before.
        ClosedEnvironmentError
            The environments have been closed.
        """
        self._refuse_closed()
        over = self._terminated | self._truncated
        if not self._begun.all() or (over.any() and self.autoreset_mode is AutoresetMode.DISABLED):
            raise ResetNeeded("an episode is over: call reset() before the next step()")
        going = ~over
        commands = self._commands(self._checked(actions, going))
        infos: dict[str, Any] = {}
        if over.any():
            self._begin(self.batch.reset(mask=over), over, infos)
        try:
            step = self.batch.step(commands, going)
        except PhysicsError:
            self._begun[going] = False
            raise
        finals: dict[int, dict[str, Any]] = {}
        for env in np.flatnonzero(going).tolist():
            self._take_in(env, self._accounts[env].go_on(step.world(env)), infos, finals)
        result = self._rewards.copy(), self._terminated.copy(), self._truncated.copy()
        if finals:
            done = np.zeros(self.num_envs, dtype=bool)
            done[list(finals)] = True
            self._begin(self.batch.reset(mask=done), done, infos)
        return self._stacked(), *result, infos

    def _take_in(
        self, env: int, told: Told, infos: dict[str, Any], finals: dict[int, dict[str, Any]]
    ) -> None:
        observed, self._rewards[env], terminated, truncated, info = told
        self._steps[env] += 1
        truncated = truncated or bool(self._steps[env] >= self._limit)
        self._observed[env] = observed
        self._terminated[env], self._truncated[env] = terminated, truncated
        if self.autoreset_mode is AutoresetMode.SAME_STEP and (terminated or truncated):
            finals[env] = info
            self._add_info(infos, {"final_obs": observed, "final_info": info}, env)
        else:
            self._add_info(infos, info, env)

    def _checked(self, actions: Any, going: Bools) -> FloatArray:
        given = np.asarray(actions, dtype=np.float64)
        if given.shape != self.action_space.shape:
            raise ValueError(
                f"actions of shape {given.shape}: must be {self.action_space.shape}, one row each"
            )
        wrong = np.flatnonzero(going & ~np.isfinite(given).all(axis=1))
        if len(wrong):
            raise ValueError(
                f"environment {wrong[0]}: action {given[wrong[0]]}: must be {given.shape[1]} "
                "finite numbers in [-1, 1]"
            )
        return np.where(going[:, None], np.clip(given, -1.0, 1.0), 0.0)

    def _commands(self, actions: FloatArray) -> FloatArray:
        """Return the actions of the batch below, (N, A)."""
        return actions

    def _stacked(self) -> Any:
        space = self.single_observation_space
        empty = create_empty_array(space, self.num_envs, fn=np.zeros)
        return concatenate(space, cast("Any", self._observed), empty)

    def _refuse_closed(self) -> None:
        if self.closed:
            raise ClosedEnvironmentError("the environments have been closed: make others")

    def close_extras(self, **kwargs: Any) -> None:
        """Free all simulations."""
        self.batch.close()


def _mode(given: AutoresetMode | str) -> AutoresetMode:
    for mode in AutoresetMode:
        if given in (mode, mode.value, mode.name):
            return mode
    known = ", ".join(mode.name for mode in AutoresetMode)
    raise ConfigError(f"autoreset mode {given!r}: must be one of {known}")
