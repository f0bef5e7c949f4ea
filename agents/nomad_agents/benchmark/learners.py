"""How each agent of the benchmark comes to be: by learning, or at once.

A new one is a class derived from `Learner` and a line where `LEARNERS` is made.
"""

import copy
from abc import ABC, abstractmethod
from collections.abc import Mapping
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass, replace
from typing import Any, Protocol

import cattrs

from nomad_agents.agent import Agent
from nomad_agents.benchmark.checks import Checks
from nomad_agents.deep import LEARNERS as DEEP
from nomad_agents.deep import DeepAgent, DeepSettings
from nomad_agents.deep.environment import make_env
from nomad_agents.deep.extra import require_extra
from nomad_agents.deep.training import DeepTraining, train_deep
from nomad_agents.experiments.learnt import learn
from nomad_agents.experiments.runs import Row
from nomad_agents.reactive_planner import CONFIGS, ReactivePlanner
from nomad_agents.registry import AGENTS, find_config, make_agent
from nomad_agents.training import Training, TrainingConfig
from nomad_mj.envs import PathFinding
from nomad_mj.errors import UnknownNameError
from nomad_mj.perception import OBSERVATIONS


class Opener(Protocol):
    """Opens the task to learn in; the caller closes it."""

    def __call__(self, **task_kwargs: Any) -> AbstractContextManager[PathFinding]:
        """Return path finding, with some options of `nomad_mj.load` in place of the task's."""
        ...


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
    checks : Checks
        To be told how far learning is, whenever a check is due.
    """

    variant: str
    seed: int
    budget: int
    open: Opener
    task: Mapping[str, Any]
    checks: Checks


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

    @abstractmethod
    def learn(self, lesson: Lesson) -> tuple[Agent, Row]:
        """Return the agent that has learnt, and what it took, names beginning with ``learn_``."""


class Untaught(Learner):
    """An agent of the registry that learns nothing."""

    variants = tuple(CONFIGS)
    learns = False

    def __init__(self, name: str) -> None:
        self.name = name

    def parameters(self, variant: str) -> Any:
        """Return the configuration."""
        return cattrs.unstructure(find_config(variant))

    def learn(self, lesson: Lesson) -> tuple[Agent, Row]:
        """Return it as it is."""
        with lesson.open() as env:
            layout = env.scene.robot.layout
        return make_agent(self.name, layout, find_config(lesson.variant)), {}


class ReactionLearner(Learner):
    """The reactive planner, by protocol P0: passes over the room's starts, a test after each.

    What it knows from the beginning is its planner, which it asks where it knows no reaction.
    Checked unaided, it trusts the nearest reaction there instead.
    """

    name = ReactivePlanner.name
    variants = tuple(CONFIGS)
    _MOST_DECISIONS = 50  # a start of the room; three passes at least, mostly more
    _MOST_PASSES = 40

    def parameters(self, variant: str) -> Any:
        """Return the configuration and when it gives up."""
        given_up = [self._MOST_DECISIONS, self._MOST_PASSES]
        return {**cattrs.unstructure(find_config(variant)), "given_up": given_up}

    def learn(self, lesson: Lesson) -> tuple[Agent, Row]:
        """Train until a test solves every start, or give up."""
        checks, latest = lesson.checks, Training()
        with lesson.open() as env:
            agent = ReactivePlanner(env.scene.robot.layout, find_config(lesson.variant))

            def check(training: Training) -> None:
                checks.take(copy.deepcopy(agent), unaided(agent), **_spent(training))

            def watch(training: Training) -> None:
                nonlocal latest
                latest = replace(training)
                tested = training.next_start == 0 and not training.testing
                if checks.due(training.decisions) or tested:
                    check(training)

            check(latest)
            most = min(lesson.budget, self._MOST_DECISIONS * len(env.scene.arena.starts))
            config = TrainingConfig(lesson.seed, max_passes=self._MOST_PASSES, max_decisions=most)
            row, _ = learn(env, agent, config, watch)
            if latest.decisions > checks.latest:  # it gave up within a pass
                check(latest)
        row |= {f"learn_{name}": value for name, value in _spent(latest).items()}
        if row["learn_solved_all"]:
            row |= {"decisions_to_test": latest.decisions, "sim_s_to_test": latest.sim_s}
        return agent, row


def unaided(agent: ReactivePlanner) -> ReactivePlanner:
    """Return a copy of an agent that trusts its nearest reaction where it would plan."""
    other = ReactivePlanner(agent.layout, replace(agent.config, no_match="nearest"))
    other.network.restore(agent.network.arrays())
    return other


class DeepLearner(Learner):
    """SAC, TD3 or PPO of Stable-Baselines3, from a budget of decisions."""

    variants = OBSERVATIONS
    deep = True
    _EVERY, _OFTEN = 500, 100  # decisions between two looks at whether a check is due

    def __init__(self, name: str, settings: DeepSettings) -> None:
        self.name = name
        self._settings = settings

    def parameters(self, variant: str) -> Any:
        """Return the settings."""
        return cattrs.unstructure(self._settings)

    def require(self) -> None:
        """Ask for PyTorch and Stable-Baselines3."""
        require_extra(curves=False)

    def learn(self, lesson: Lesson) -> tuple[Agent, Row]:
        """Train until the budget is spent."""
        checks, training = lesson.checks, DeepTraining()
        env = make_env(self._settings, lesson.variant, **lesson.task)

        def evaluate(agent: DeepAgent, decisions: int, sim_s: float) -> None:
            if checks.due(decisions) or decisions >= lesson.budget:
                checks.take(agent, None, **_spent(training))

        every = min(self._OFTEN if checks.whole else self._EVERY, lesson.budget)
        with closing(env):
            agent = train_deep(
                self._settings, env, lesson.seed, lesson.budget, every, evaluate, training=training
            )
        return agent, {f"learn_{name}": value for name, value in _spent(training).items()}


def _spent(training: Training | DeepTraining) -> dict[str, float]:
    """Return what learning has taken so far."""
    names = ("decisions", "sim_s", "virtual_collisions", "bumper_contacts")
    return {name: getattr(training, name) for name in names}


LEARNERS: Mapping[str, Learner] = {
    each.name: each
    for each in (
        *(Untaught(name) for name in AGENTS if name != ReactivePlanner.name),
        ReactionLearner(),
        *(DeepLearner(name, settings()) for name, settings in DEEP.items()),
    )
}


def usual_agents() -> tuple[str, ...]:
    """Return all agents that need no hours, the learners among them in all their variants."""
    return tuple(
        f"{each.name}:{variant}" if each.learns else each.name
        for each in LEARNERS.values()
        if not each.deep
        for variant in (each.variants if each.learns else each.variants[:1])
    )


def find_learner(spec: str) -> tuple[Learner, str]:
    """Return the learner and the variant that ``NAME`` or ``NAME:VARIANT`` means.

    Raises
    ------
    UnknownNameError
        There is no such agent or variant.
    """
    name, _, variant = spec.partition(":")
    if name not in LEARNERS:
        raise UnknownNameError("agent", name, LEARNERS)
    learner = LEARNERS[name]
    variant = variant or learner.variants[0]
    if variant not in learner.variants:
        raise UnknownNameError(f"variant of {name}", variant, learner.variants)
    return learner, variant
