"""What a learner is: it gets a lesson and returns the agent that has learnt."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Any, Protocol

from nomad_agents.agent import Agent
from nomad_agents.studies.runs import Row
from nomad_mj.envs import PathFinding


class Opener(Protocol):
    """Opens the task to learn in; the caller closes it."""

    def __call__(self, **task_kwargs: Any) -> AbstractContextManager[PathFinding]:
        """Return path finding, with some options of `nomad_mj.load` in place of the task's."""
        ...


class Examiner(Protocol):
    """Is told how far learning is, and looks at what has been learnt.

    Attributes
    ----------
    whole : bool
        Whether it looks all along, and close together.
    latest : float
        Decisions of learning when it looked last; -1 before the first time.
    """

    whole: bool
    latest: float

    def due(self, decisions: int) -> bool:
        """Return whether it wants to look after so many decisions of learning."""
        ...

    def take(self, agent: Agent, unaided: Agent | None = None, **learning: float) -> None:
        """Look at an agent, also without what taught it, after ``decisions`` and more."""
        ...


class Unexamined:
    """Nobody looks while an agent learns."""

    whole = False
    latest = float("inf")

    def due(self, decisions: int) -> bool:
        """Return False."""
        return False

    def take(self, agent: Agent, unaided: Agent | None = None, **learning: float) -> None:
        """Do nothing."""


@dataclass(frozen=True)
class Lesson:
    """What is to be learnt, and with what.

    Attributes
    ----------
    variant : str
        One of the learner's.
    seed : int
        Of all randomness.
    budget : int
        Decisions of learning, at most.
    open : Opener
        The task.
    task : dict
        The same as arguments of `nomad_mj.load`, for those who make environments of their own.
    checks : Examiner
        To be told how far learning is, whenever a check is due.
    """

    variant: str
    seed: int
    budget: int
    open: Opener
    task: Mapping[str, Any]
    checks: Examiner = field(default_factory=Unexamined)


class Learner(ABC):
    """How an agent comes to be.

    Attributes
    ----------
    name : str
        As on the command line.
    variants : tuple of str
        What can follow it there after a colon; the first is meant where nothing does.
    learns, deep : bool
        Whether it learns; whether it takes hours to, and packages that are not always installed.
    """

    name: str
    variants: tuple[str, ...]
    learns: bool = True
    deep: bool = False

    @abstractmethod
    def parameters(self, variant: str) -> Any:
        """Return with what it learns, as data: a result of other values is stale."""

    def require(self) -> None:
        """Raise ConfigError if something must be installed first."""

    def check_budget(self, budget: int) -> None:
        """Raise ConfigError if it can learn nothing from so few decisions."""

    @abstractmethod
    def learn(self, lesson: Lesson) -> tuple[Agent, Row]:
        """Return the agent that has learnt, and what it took, names beginning with ``learn_``."""
