"""A robot that is driven, by hand or by an agent, one control step at a time."""

import math
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager

import numpy as np
from dm_control.rl.control import PhysicsError

from nomad_agents.agent import Agent
from nomad_agents.viewer.controls import DRIVING, Controls
from nomad_agents.viewer.teleoperation import Teleoperator, Wish
from nomad_mj.envs import PathFinding, percept_of
from nomad_mj.errors import StartError
from nomad_mj.motion import Outcome, displacement
from nomad_mj.perception import Percept, SituationSpec
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.tasks import Start
from nomad_mj.types import FloatArray, IntArray

_STILL = 0.01  # [m/s]
_MOVES = {
    Outcome.VIRTUAL_COLLISION: "stopped before an obstacle",
    Outcome.BUMPED: "bumped",
    Outcome.TIMED_OUT: "move timed out",
}


class _TakenOverError(Exception):
    """Ends a move of the agent's: the driver wants something."""


class ClosedError(Exception):
    """Raised by `Session.on_step`: nobody wants to see any more."""


class Session:
    """Drives the robot as the controls say.

    Parameters
    ----------
    env : PathFinding
        Robot and room; its `on_control_step` is the session's. By hand, the motor task inside it
        is driven.
    controls : Controls
        What the driver asks for.
    agent : Agent, optional
        Drives when it is asked to, from the beginning on.
    start : str, int or sequence of float, optional
        Where each episode starts; None for starts of the room's at random.
    seed : int
        Of the starts and the noise.
    clock : callable
        Tells the time [s].

    Attributes
    ----------
    on_step : callable
        Called after each control step, and after each reset; may raise `ClosedError`.
    agent_drives : bool
        Whether the agent does, not the hand.
    news : str
        What happened last, in words.
    move : array (2,) or None
        The agent's present move [m], world frame.
    episodes : int
        Resets so far.
    """

    def __init__(
        self,
        env: PathFinding,
        controls: Controls,
        agent: Agent | None = None,
        *,
        start: Start = None,
        seed: int = 0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.env, self.controls, self.agent = env, controls, agent
        self.on_step: Callable[[], None] = lambda: None
        self.news = self._refusal = ""
        self.move: FloatArray | None = None
        self.episodes = 0
        self.agent_drives = agent is not None
        self._start, self._clock = start, clock
        drive = env.scene.robot.drive
        self._hand = Teleoperator(drive.limits, CONTROL_TIMESTEP, wheel=drive.kind == "car")
        self._situation = agent.situation if agent else SituationSpec()
        self._seed: int | None = seed
        env.on_control_step = self._after_agent
        self._reset(start)

    @contextmanager
    def shown_by(self, on_step: Callable[[], None]) -> Generator[None, None, None]:
        """Let `on_step` show the session in a ``with`` block, and nobody after it."""
        self.on_step = on_step
        try:
            yield
        finally:
            self.on_step = lambda: None

    def advance(self) -> None:
        """Obey the controls, then drive one control step by hand or one move by the agent."""
        try:
            self._advance()
        except PhysicsError as error:
            self._let_go()
            self._reset(self._start)
            self.news = f"started again: {error}"

    def _advance(self) -> None:
        for request in self.controls.take(DRIVING):
            self._obey(request)
        wish, heard = self.controls.wish
        if self.controls.urgent:
            self._let_go()
        self._hand.hold(wish, heard)
        if self.agent_drives and self.agent is not None:
            self._decide(self.agent)
            return
        robot, task = self.env.scene.robot, self.env.motor.task
        twist = self._hand.twist(self._clock())
        self._last = self.env.motor.step(robot.drive.twist(*twist, task.travel))
        self._tell()
        self.on_step()

    def _obey(self, request: str) -> None:
        if request == "agent" and self.agent is not None:
            if self.agent_drives:
                self._let_go()
                return
            try:  # path finding has not seen what was driven by hand: it begins here
                self._reset([*self.env.physics.pose()])
            except StartError as error:
                self._refusal = self.news = f"{self.agent.name} cannot start here: {error}"
                return
            self.agent_drives, self.news = True, ""
        elif request == "reset":
            self.agent_drives = self.agent is not None
            try:
                self._reset(self._start)
            except StartError as error:  # what moves is in the way; the next try is another one
                self._let_go()
                self.news = str(error)
        elif request == "stop":
            self._let_go()
            self.controls.hold(Wish())

    def _reset(self, start: Start) -> None:
        self._last = self.env.reset(self._seed, start)
        self._seed = None
        self._hand.halt()
        if self.agent is not None:
            self.agent.start_episode(self.env.motor.task.random)
        self.move, self.news, self._refusal = None, "", ""
        self.episodes += 1
        self.on_step()

    def _let_go(self) -> None:
        """Take the wheel from the agent."""
        if self.agent_drives:
            self.agent_drives, self.news = False, ""
        self.move = None

    def _decide(self, agent: Agent) -> None:
        """Let the agent decide and carry out its move, unless the driver takes over."""
        percept = self.percept()
        decision = agent.act(percept, None)
        if decision.kind == "none":
            self._let_go()
            self.news = f"{agent.name} knows no further"
            return
        self.move = displacement(decision.action, percept.goal, self.env.config.action)
        self.news = f"{agent.name} {decision.kind}"
        try:
            self._last = self.env.step(decision.action)
        except _TakenOverError:
            self._let_go()
            return
        outcome = Outcome(int(self._last.observation["outcome"]))
        self.news = _MOVES.get(outcome, self.news)
        if self._last.last():
            self._let_go()
            self.news = "goal reached" if self._last.discount == 0.0 else "time is up"

    def _after_agent(self) -> None:
        self._last = self.env.motor.told()
        self.on_step()
        if self.controls.urgent:
            raise _TakenOverError

    def _tell(self) -> None:
        """Say what has become of driving by hand."""
        task, travel = self.env.motor.task, self.env.motor.task.travel
        way = math.hypot(travel.forward, travel.sideways)
        moves = way > _STILL * CONTROL_TIMESTEP
        if self._refusal and not moves:  # told until the robot drives on
            self.news = self._refusal
            return
        self._refusal = ""
        if self.touched.size:
            self.news = "bumper touched"
        elif task.goal_distance(self.env.physics) <= task.config.goal_radius:
            self.news = "goal reached"
        elif self.news == "bumper touched" or moves:
            self.news = ""

    @property
    def driver(self) -> str:
        """Who drives: the agent's name, or "hand"."""
        return self.agent.name if self.agent_drives and self.agent is not None else "hand"

    @property
    def speed(self) -> float:
        """How fast the robot drives, by its encoders [m/s]."""
        travel = self.env.motor.task.travel
        way = math.hypot(travel.forward, travel.sideways)
        return math.copysign(way, travel.forward) / CONTROL_TIMESTEP

    @property
    def touched(self) -> IntArray:
        """Numbers of the bumpers that are touched."""
        return np.flatnonzero(self._last.observation["bumpers"])

    def percept(self) -> Percept:
        """Return what an agent perceives now: the certainty grid and the way to the goal."""
        return percept_of(self._last.observation, self.env.scene.robot.layout, self._situation)

    @property
    def cell(self) -> float:
        """Side of a cell of the certainty grid [m]."""
        return self._situation.grid.resolution
