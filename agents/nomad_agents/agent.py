"""What an agent is: percepts in, decisions out, and learning in between."""

from abc import ABC, abstractmethod
from typing import Literal, NamedTuple

import numpy as np

from nomad_mj.perception import Percept, SituationSpec
from nomad_mj.types import FloatArray, SensorLayout

DecisionKind = Literal["reacted", "planned", "none"]


class Decision(NamedTuple):
    """What an agent decided at one place.

    Attributes
    ----------
    action : array (2,)
        (dx, dy) in [-1, 1], relative to the shortest path vector.
    kind : "reacted", "planned" or "none"
        Where the action came from; "none": the agent does not know how to act.
    category : int
        The category that acted, -1 where there is none.
    drawn : array (2,)
        What exploration drew (l of Eq 15), for learning.
    mean : array (2,)
        What it was drawn around (mu of Eq 12).
    unmatched : bool
        Whether the situation was unlike any that is known, for an agent that does not learn.
    """

    action: FloatArray
    kind: DecisionKind
    category: int = -1
    drawn: FloatArray = np.zeros(2)
    mean: FloatArray = np.zeros(2)
    unmatched: bool = False


class Agent(ABC):
    """Decides where to move next.

    Attributes
    ----------
    name : str
        As on the command line.
    layout : SensorLayout
        The sensors it was made for.
    situation : SituationSpec
        How it wants its percepts.
    """

    name: str

    def __init__(self, layout: SensorLayout, situation: SituationSpec) -> None:
        self.layout = layout
        self.situation = situation

    def start_episode(self, chance: np.random.Generator | None = None) -> None:
        """Forget the path of the episode before; nothing that was learnt is lost.

        Parameters
        ----------
        chance : numpy.random.Generator, optional
            The episode's own stream, for an agent that acts by chance even when it does not learn.
        """

    @abstractmethod
    def act(self, percept: Percept, explore: np.random.Generator | None) -> Decision:
        """Return the decision for a percept.

        Parameters
        ----------
        percept : Percept
            What is perceived at one place.
        explore : numpy.random.Generator or None
            The stream of exploration while learning; None acts greedily and learns nothing.
        """

    def learn(
        self, percept: Percept, decision: Decision, reward: float, collided: bool, after: Percept
    ) -> None:
        """Take in what became of a decision that did not end at the goal.

        Parameters
        ----------
        percept, decision
            What was perceived and decided.
        reward : float
            z of Eq 6.
        collided : bool
            Whether a virtual collision or a contact ended the move.
        after : Percept
            What is perceived now.
        """

    def reach_goal(self, percept: Percept, decision: Decision, reward: float) -> None:
        """Take in a decision that ended at the goal; the path so far may be learnt from."""
