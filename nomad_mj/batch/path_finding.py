"""Path finding of many robots, one move of each at a time."""

from collections import OrderedDict
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from dm_env import specs

from nomad_mj.batch.environment import BatchEnvironment
from nomad_mj.batch.specs import stacked_bounded
from nomad_mj.batch.timestep import LAST, BatchTimeStep
from nomad_mj.batch.worlds import Mask, Worlds
from nomad_mj.envs import PathFindingConfig
from nomad_mj.envs.driving import Driving, Lookout, Move, asked_move, reward_of
from nomad_mj.envs.path_finding import move_spec, told_of_moves
from nomad_mj.motion import Outcome
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.types import FloatArray, IntArray


class _Underway(NamedTuple):
    """A move that a world carries out.

    Attributes
    ----------
    driving : Driving
        Its control, and what it has been like so far.
    asked : array (2,)
        The way that was asked for [m].
    goal : array (2,)
        From the robot to the goal when it began [m].
    """

    driving: Driving
    asked: FloatArray
    goal: FloatArray


class BatchPathFinding(BatchEnvironment):
    """Many `PathFinding` side by side: one decision (dx, dy) each, (N, 2).

    `step` carries out one move of every world. Moves end at different times: who is there already
    waits for the others. Where nobody should wait, `start_moves` and `advance` do the same by the
    control step, and whoever has finished can be given its next move at once.

    A world whose episode is over begins another one in its next step, whatever its action is.

    Parameters
    ----------
    worlds : Worlds
        The robots and their rooms; reaching the goal must not end their motor tasks.
    config : PathFindingConfig
        Options.
    time_limit : float
        Length of an episode [s of simulated time].
    """

    def __init__(
        self,
        worlds: Worlds,
        config: PathFindingConfig | None = None,
        time_limit: float = 300.0,
    ) -> None:
        super().__init__(worlds, time_limit)
        self.config = config or PathFindingConfig()
        self._robot = worlds.tasks[0].scene.robot
        self._lookout = Lookout(self._robot.layout, self.config.motion)
        self._moves: dict[int, _Underway] = {}  # by world
        self._ticks = np.zeros(worlds.count, dtype=np.intp)
        self._duration, self._driven, self._clearance = np.zeros((3, worlds.count))
        self._outcome, self._contact = np.zeros((2, worlds.count), dtype=np.int32)

    @property
    def moving(self) -> npt.NDArray[np.bool_]:
        """Whose move is under way, (N,)."""
        result = np.zeros(self.count, dtype=bool)
        result[list(self._moves)] = True
        return result

    def action_spec(self) -> specs.BoundedArray:
        """Return (dx, dy) in [-1, 1], (N, 2)."""
        return stacked_bounded(move_spec(), self.count)

    def single_observation_spec(self) -> "OrderedDict[str, specs.Array]":
        """Return the motor task's observations of one world and what is told of a move."""
        spec = self.tasks[0].sensor_spec()
        spec.update(told_of_moves(self.config.motion))
        return spec

    def step(self, actions: npt.ArrayLike, mask: Mask = None) -> BatchTimeStep:
        """Carry out one move of each world and return what became of them.

        Parameters
        ----------
        actions : array_like (N, 2)
            (dx, dy) of each.
        mask : sequence of bool, length N, optional
            Which worlds; the others wait, and their last time step is told again. None for all.

        Raises
        ------
        ValueError
            Actions of another shape or not finite, or a move of `start_moves` is under way.
        PhysicsError
            A simulation diverged, naming the worlds. All whose move was under way begin a new
            episode at their next step.
        """
        for world in self._moves:
            raise ValueError(f"world {world}: its move is under way; advance() until it is over")
        self.start_moves(actions, mask)
        while self._moves:
            self.advance()
        return self.time_step()

    def start_moves(self, actions: npt.ArrayLike, mask: Mask = None) -> None:
        """Let worlds begin a move; those whose episode is over begin a new one instead.

        Arguments and errors as of `step`. A world whose move is under way must not be chosen.
        """
        chosen = self.worlds.chosen(mask)
        given = self._check_actions(actions, 2)
        busy = [world for world in chosen.tolist() if world in self._moves]
        if busy:
            raise ValueError(f"world {busy[0]}: its move is under way; advance() until it is over")
        over = self._type[chosen] == LAST
        goals = self.worlds.goal
        spec = self.config.action
        asked = {
            world: asked_move(given[world], goals[world], spec, f"world {world}: action")
            for world in chosen[~over].tolist()
        }
        if over.any():
            self._begin(chosen[over])
        for world, move in asked.items():
            bumped = int(np.count_nonzero(self.worlds.bumpers[world]))
            odometry = self.worlds.odometry[world].tolist()
            touched = int(np.count_nonzero(self.worlds.touched[world]))
            driving = Driving(move, self._robot, self._lookout.motion, odometry, bumped, touched)
            self._moves[world] = _Underway(driving, move, goals[world].copy())

    def advance(self) -> npt.NDArray[np.bool_]:
        """Go on with all moves by a control step; return whose are over since the last call, (N,).

        Those stand where they are until they are given another move; `time_step` tells of them.
        """
        finished = np.zeros(self.count, dtype=bool)
        commands: list[tuple[float, ...]] = []
        going: list[int] = []
        worlds = sorted(self._moves)
        for world, free in zip(worlds, self._free(worlds), strict=True):
            command = self._moves[world].driving.command(free)
            if command is None:
                self._finish(world)
                finished[world] = True
            else:
                going.append(world)
                commands.append(command)
        if going:
            self._drive(going, np.array(commands))
        return finished

    def _free(self, worlds: list[int]) -> list[float]:
        """Return the shortest reading ahead of each of some worlds [m]."""
        if not worlds:
            return []
        watched = np.array([self._moves[world].driving.watched for world in worlds])
        slack = self._lookout.slacks(*watched.T)
        return np.minimum.reduce(self.worlds.ranges[worlds] + slack, axis=1).tolist()

    def _drive(self, going: list[int], commands: FloatArray) -> None:
        """Advance worlds by a control step of their moves, given their commands (n, M)."""
        worlds = self.worlds
        chosen = np.array(going, dtype=np.intp)
        try:
            worlds.step(chosen, commands)
        except Exception:
            self._type[going] = LAST
            self._moves.clear()
            raise
        nearest = np.minimum.reduce(worlds.ranges[chosen], axis=1).tolist()
        bumped = np.count_nonzero(worlds.bumpers[chosen], axis=1).tolist()
        touched = np.count_nonzero(worlds.touched[chosen], axis=1).tolist()
        for world, *told in zip(going, nearest, bumped, touched, strict=True):
            travel, odometry = worlds.tasks[world].travel, worlds.odometry[world].tolist()
            self._moves[world].driving.take_in(travel, odometry, *told)

    def _finish(self, world: int) -> None:
        """Note what became of the move of a world."""
        move = self._moves.pop(world)
        done = move.driving.result()
        self._ticks[world] += done.ticks
        self._note(world, done)
        task = self.worlds.tasks[world]
        ended = task.reaches_goal(task.goal_distance(self.worlds.worlds[world]))
        elapsed = self._ticks[[world]] * CONTROL_TIMESTEP >= self._time_limit
        reward = reward_of(done, move.asked, move.goal)
        self._tell(np.array([world]), [reward], np.array([ended]), elapsed)

    def _note(self, world: int, done: Move) -> None:
        """Let the observations of a world tell of a move."""
        self._duration[world] = done.ticks * CONTROL_TIMESTEP
        self._driven[world] = done.driven
        self._clearance[world] = done.clearance
        self._outcome[world] = int(done.outcome)
        self._contact[world] = int(done.contact)

    def _begun(self, chosen: IntArray) -> None:
        self._ticks[chosen] = 0
        for world in chosen.tolist():
            self._moves.pop(world, None)
            self._note(world, Move(Outcome.NONE, float(self.worlds.ranges[world].min())))

    def _observe(self) -> "OrderedDict[str, npt.NDArray[Any]]":
        told: OrderedDict[str, npt.NDArray[Any]] = OrderedDict(self.worlds.observe())
        told["duration"] = self._duration.copy()
        told["driven"] = self._driven.copy()
        told["clearance"] = self._clearance.copy()
        told["outcome"] = self._outcome.copy()
        told["contact"] = self._contact.copy()
        return told
