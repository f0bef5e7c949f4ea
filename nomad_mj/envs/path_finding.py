"""Path finding: the decision level of the paper, a `dm_env` environment above the motor task."""

from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import dm_env
import numpy as np
from dm_control.rl.control import PhysicsError
from dm_env import specs

from nomad_mj.envs.driving import Driving, Lookout, Move, asked_move, reward_of
from nomad_mj.errors import ConfigError
from nomad_mj.motion import ActionSpec, MotionConfig, Outcome
from nomad_mj.scene import CONTROL_TIMESTEP, Scene
from nomad_mj.tasks import MotorEnvironment, NavigationPhysics, Start
from nomad_mj.types import FloatArray


@dataclass(frozen=True)
class PathFindingConfig:
    """Options of path finding beside those of the motor task.

    Attributes
    ----------
    action : ActionSpec
        Lengths of moves.
    motion : MotionConfig
        How carefully moves are carried out.
    """

    action: ActionSpec = field(default_factory=ActionSpec)
    motion: MotionConfig = field(default_factory=MotionConfig)


def move_spec() -> specs.BoundedArray:
    """Return the limits of an action: (dx, dy) in [-1, 1]."""
    return specs.BoundedArray((2,), np.float64, -1.0, 1.0, name="move")


def told_of_moves(motion: MotionConfig) -> "OrderedDict[str, specs.Array]":
    """Return the shapes and limits of what is told of a move."""
    return OrderedDict(
        duration=specs.BoundedArray((), np.float64, 0.0, motion.longest, name="duration"),
        driven=specs.BoundedArray((), np.float64, 0.0, np.inf, name="driven"),
        clearance=specs.BoundedArray((), np.float64, 0.0, np.inf, name="clearance"),
        outcome=specs.DiscreteArray(len(Outcome), np.int32, name="outcome"),
        contact=specs.DiscreteArray(2, np.int32, name="contact"),
    )


class PathFinding(dm_env.Environment):
    """Find the way to the goal, one move at a time.

    The action is (dx, dy) in [-1, 1] in the frame of the shortest path vector. A step lasts until
    the move is done, stopped by a virtual collision (the robot then retracts), bumped or timed
    out. Observations are those of the motor task after the move, and of the move itself:
    ``duration`` [s], ``driven`` (length of the way, there and back) [m], ``clearance`` (shortest
    reading on the way) [m], ``outcome`` (see `Outcome`), ``contact`` (1 if a bumper was truly
    touched, in whatever part of the move and whatever it reported). The reward is z of Eqs 6-8.
    Reaching the goal ends the episode with discount 0, the time limit with discount 1. A goal that
    moves is reached if it is there when a move ends, not if it comes by during one.

    Parameters
    ----------
    motor : MotorEnvironment
        The motor task that carries out the moves; neither its goal nor its time limit may end
        the episode.
    config : PathFindingConfig
        Options.
    time_limit : float
        Length of an episode [s of simulated time].
    """

    def __init__(
        self,
        motor: MotorEnvironment,
        config: PathFindingConfig | None = None,
        time_limit: float = 300.0,
    ) -> None:
        if not time_limit > 0:
            raise ConfigError(f"time limit {time_limit}: must be above 0 s")
        self.motor = motor
        self.config = config or PathFindingConfig()
        self.on_control_step: Callable[[], None] | None = None
        self._time_limit = time_limit
        self._lookout = Lookout(self.scene.robot.layout, self.config.motion)
        self._over = True
        self._ticks = 0

    @property
    def scene(self) -> Scene:
        """The robot and the room."""
        return self.motor.task.scene

    @property
    def physics(self) -> NavigationPhysics:
        """The simulation."""
        return self.motor.physics

    def action_spec(self) -> specs.BoundedArray:
        """Return (dx, dy) in [-1, 1]."""
        return move_spec()

    def reward_spec(self) -> specs.BoundedArray:
        """Return z in [-1, 0]; lower if moves can be longer than 1 m."""
        lowest = -(1.0 + self.config.action.longest) / 2
        return specs.BoundedArray((), np.float64, lowest, 0.0, name="reward")

    def observation_spec(self) -> "OrderedDict[str, specs.Array]":
        """Return the motor task's observations and what is told of the move."""
        result = OrderedDict(self.motor.observation_spec())
        result.update(told_of_moves(self.config.motion))
        return result

    def reset(
        self, seed: int | np.random.SeedSequence | None = None, start: Start = None
    ) -> dm_env.TimeStep:
        """Start a new episode; arguments and errors as of `MotorEnvironment.reset`."""
        self._over = True  # should it be refused
        told = self.motor.reset(seed, start).observation
        self._over = False
        self._ticks = 0
        nearest = float(self.motor.task.ranges.min())
        return dm_env.restart(_with_move(told, Move(Outcome.NONE, nearest)))

    def step(self, action: Any) -> dm_env.TimeStep:
        """Carry out one move and return what became of it.

        Raises
        ------
        ValueError
            An action that is not two finite numbers.
        PhysicsError
            The simulation diverged. The next step begins a new episode.
        """
        if self._over:
            return self.reset()
        task = self.motor.task
        goal = task.goal - task.odometry[:2]
        move = asked_move(action, goal, self.config.action)
        done = self._carry_out(move)
        reward = reward_of(done, move, goal)
        observation = _with_move(task.get_observation(self.physics), done)
        if task.reaches_goal(task.goal_distance(self.physics)):
            self._over = True
            return dm_env.termination(reward, observation)
        if self._ticks * CONTROL_TIMESTEP >= self._time_limit:
            self._over = True
            return dm_env.truncation(reward, observation, 1.0)
        return dm_env.transition(reward, observation, 1.0)

    def _carry_out(self, move: FloatArray) -> Move:
        """Drive a displacement (2,) [m]."""
        motor, lookout = self.motor, self._lookout
        task = motor.task
        bumped = int(np.count_nonzero(task.bumpers))
        driving = Driving(
            move, self.scene.robot, lookout.motion, task.odometry, bumped, task.own.touched
        )
        while True:
            slack = lookout.slack(*driving.watched)
            command = driving.command(float(np.minimum.reduce(task.ranges + slack)))
            if command is None:
                return driving.result()
            try:
                motor.advance(command)
            except PhysicsError:
                self._over = True
                raise
            self._ticks += 1
            bumped = int(np.count_nonzero(task.bumpers))
            nearest = float(np.minimum.reduce(task.ranges))
            driving.take_in(task.travel, task.odometry, nearest, bumped, task.own.touched)
            if self.on_control_step is not None:
                self.on_control_step()

    def close(self) -> None:
        """Free the simulation and its OpenGL contexts."""
        self._over = True  # so that the next step says that it is closed
        self.motor.close()


def _with_move(told: "OrderedDict[str, Any]", move: Move) -> "OrderedDict[str, Any]":
    """Return the motor task's observations and what is told of a move."""
    observation = OrderedDict(told)
    observation["duration"] = np.array(move.ticks * CONTROL_TIMESTEP)
    observation["driven"] = np.array(move.driven)
    observation["clearance"] = np.array(move.clearance)
    observation["outcome"] = np.array(int(move.outcome), dtype=np.int32)
    observation["contact"] = np.array(int(move.contact), dtype=np.int32)
    return observation
