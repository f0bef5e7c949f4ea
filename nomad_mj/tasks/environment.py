"""dm_control's environment, with a seed and a start for `reset` and a `close` that closes."""

import math
from collections import OrderedDict
from typing import Any

import dm_env
import numpy as np
from dm_control.rl import control
from dm_control.rl.control import PhysicsError
from dm_env import specs

from nomad_mj.errors import ConfigError
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.tasks.motor import MotorTask
from nomad_mj.tasks.physics import NavigationPhysics
from nomad_mj.tasks.seeds import seed_sequence
from nomad_mj.tasks.starts import Start


class MotorEnvironment(control.Environment):
    """A `dm_control.rl.control.Environment` around a `MotorTask`.

    Parameters
    ----------
    task : MotorTask
        The task; the simulation is made from its scene.
    time_limit : float
        Length of an episode [s of simulated time]; its end is a truncation, discount 1.
    flat_observation : bool
        Concatenate all observations into one array.
    """

    def __init__(
        self,
        task: MotorTask,
        time_limit: float = 120.0,
        flat_observation: bool = False,
    ) -> None:
        if not time_limit > 0:
            raise ConfigError(f"time limit {time_limit}: must be above 0 s")
        super().__init__(
            NavigationPhysics.from_scene(
                task.scene, task.config.range_noise.grazing, task.config.infrared
            ),
            task,
            time_limit=time_limit,
            control_timestep=CONTROL_TIMESTEP,
            flat_observation=flat_observation,
        )
        self._action_shape = task.motor_spec().shape
        self._closed = False

    def reset(
        self, seed: int | np.random.SeedSequence | None = None, start: Start = None
    ) -> dm_env.TimeStep:
        """Start a new episode.

        Parameters
        ----------
        seed : int or SeedSequence, optional
            Start the sequence of episodes anew from it; None goes on with the present one.
        start : str, int or sequence of float, optional
            Name or number of a start of the room's, or x, y[, heading] in metres and radians;
            None for one of the room's at random.

        Raises
        ------
        StartError, UnknownNameError
            See `starts.resolve_start`; a StartError also where obstacles that move find no place.
            The next step, or reset, begins another episode then.
        RuntimeError
            The environment has been closed.
        """
        self._refuse_closed()
        sequence = None if seed is None else seed_sequence(seed)  # refused, it leaves no trace
        if start is not None:
            self.task.start_next_at(start)
        if sequence is not None:
            self.task.seed(sequence)
        try:
            return super().reset()
        except BaseException:
            self._reset_next_step = True  # the robot is nowhere
            raise

    def step(self, action: Any) -> dm_env.TimeStep:
        """Do a control step; begin a new episode if the last one is over.

        Raises
        ------
        ValueError
            An action that is not one finite number for each motor.
        PhysicsError
            The simulation diverged. The next step begins a new episode.
        """
        self._refuse_closed()
        if self._reset_next_step:
            return self.reset()
        action = np.asarray(action, dtype=np.float64)
        if action.shape != self._action_shape or not math.isfinite(sum(action.tolist())):
            (count,) = self._action_shape
            raise ValueError(f"action {action}: must be {count} finite numbers, one for each motor")
        try:
            return super().step(action)
        except PhysicsError:
            self._reset_next_step = True
            raise

    def advance(self, command: Any) -> None:
        """Do a control step of an episode that nothing ends, without a time step: see `told`.

        What the sensors read is in the task's attributes: for whoever looks at few of them. Time
        limit and goal do not end the episode here.

        Raises
        ------
        RuntimeError
            No episode is under way.
        """
        if self._reset_next_step:
            raise RuntimeError("no episode is under way: reset() begins one")
        self._step_count += 1
        self._task.before_step(command, self._physics)
        self._physics.step(self._n_sub_steps)
        self._task.sense(self._physics)

    def told(self) -> dm_env.TimeStep:
        """Return the time step of the control step that `advance` did last, or of the reset."""
        task, physics = self._task, self._physics
        observation = task.get_observation(physics)
        if self._flat_observation:
            observation = control.flatten_observation(observation)
        if not self._step_count:
            return dm_env.restart(observation)
        return dm_env.transition(task.get_reward(physics), observation)

    def observation_spec(self) -> Any:
        """Return the shapes and limits of the observations; flat ones have no limits."""
        spec = super().observation_spec()
        if not self._flat_observation:
            return spec
        size = sum(math.prod(part.shape) for part in spec.values())
        name = control.FLAT_OBSERVATION_KEY
        return OrderedDict([(name, specs.Array((size,), np.float64, name=name))])

    def _refuse_closed(self) -> None:
        if self._closed:
            raise RuntimeError("the environment has been closed: load another one")

    def close(self) -> None:
        """Free the simulation and its OpenGL contexts; more than once does no harm."""
        self._closed = self._reset_next_step = True
        self.physics.free()
