"""One episode: an agent finds its way, or does not, and what it took."""

from collections.abc import Callable
from typing import NamedTuple

import dm_env
import numpy as np

from nomad_agents.agent import Agent, Decision
from nomad_mj.envs import PathFinding, percept_of
from nomad_mj.motion import Outcome
from nomad_mj.perception import Percept
from nomad_mj.tasks import Start


class Episode(NamedTuple):
    """What an episode took.

    Attributes
    ----------
    reached : bool
        Whether it ended at the goal.
    decisions, reactions, unmatched : int
        Moves made; those by a learnt reaction; situations unlike any exemplar.
    virtual_collisions, bumper_contacts : int
        Moves that ended so; moves in which something was touched, in whatever part.
    duration : float
        Simulated time [s].
    driven : float
        Length of the way, retreats included [m].
    clearance : float
        Shortest reading of any range sensor [m].
    """

    reached: bool
    decisions: int
    reactions: int
    unmatched: int
    virtual_collisions: int
    bumper_contacts: int
    duration: float
    driven: float
    clearance: float

    @property
    def strict(self) -> bool:
        """Whether the goal was reached without a virtual collision or a contact."""
        return self.reached and self.virtual_collisions + self.bumper_contacts == 0


class Turn(NamedTuple):
    """A decision and what came of it, for those who look on."""

    percept: Percept
    decision: Decision
    after: dm_env.TimeStep | None


Watcher = Callable[[Turn], None]


def run_episode(
    env: PathFinding,
    agent: Agent,
    *,
    seed: int | np.random.SeedSequence | None = None,
    start: Start = None,
    explore: np.random.Generator | None = None,
    max_decisions: int = 100,
    watch: Watcher | None = None,
) -> Episode:
    """Let an agent act until it reaches the goal, knows no further or runs out of time.

    Parameters
    ----------
    env, agent
        Of the same robot.
    seed, start
        As of `PathFinding.reset`.
    explore : numpy.random.Generator, optional
        Stream of exploration: the agent learns. Without it the agent is greedy and unchanged.
    max_decisions : int
        The episode is given up after so many.
    watch : callable, optional
        Called with each decision before the move (`after` None) and after it.
    """
    step = env.reset(seed, start)
    agent.start_episode(env.motor.task.random)
    percept = percept_of(step.observation, agent.layout, agent.situation)
    tally = _Tally(float(step.observation["clearance"]))
    while not step.last() and tally.decisions < max_decisions:
        decision = agent.act(percept, explore)
        tally.unmatched += decision.unmatched
        if decision.kind == "none":
            break  # the agent does not know how to act
        if watch is not None:
            watch(Turn(percept, decision, None))
        step = env.step(decision.action)
        if watch is not None:
            watch(Turn(percept, decision, step))
        tally.take_in(decision, step)
        after = percept_of(step.observation, agent.layout, agent.situation)
        if explore is not None and tally.reached:
            agent.reach_goal(percept, decision, float(step.reward))
        elif explore is not None:
            agent.learn(percept, decision, float(step.reward), tally.collided, after)
        percept = after
    return tally.episode()


class _Tally:
    """Counts up what an episode takes."""

    def __init__(self, clearance: float) -> None:
        self.decisions = self.reactions = self.unmatched = 0
        self.contacts = 0
        self.outcomes: list[int] = []
        self.duration = self.driven = 0.0
        self.clearance = clearance
        self.reached = False

    @property
    def collided(self) -> bool:
        """Whether a virtual collision or a contact ended the newest move."""
        return self.outcomes[-1] in (Outcome.VIRTUAL_COLLISION, Outcome.BUMPED)

    def take_in(self, decision: Decision, step: dm_env.TimeStep) -> None:
        """Count a decision and the move it led to."""
        seen = step.observation
        self.decisions += 1
        self.reactions += decision.kind == "reacted"
        self.outcomes.append(int(seen["outcome"]))
        self.contacts += int(seen["contact"])
        self.duration += float(seen["duration"])
        self.driven += float(seen["driven"])
        self.clearance = min(self.clearance, float(seen["clearance"]))
        self.reached = step.last() and step.discount == 0.0

    def episode(self) -> Episode:
        """Return the sums."""
        return Episode(
            self.reached,
            self.decisions,
            self.reactions,
            self.unmatched,
            self.outcomes.count(Outcome.VIRTUAL_COLLISION),
            self.contacts,
            self.duration,
            self.driven,
            self.clearance,
        )
