"""What the options of one run come to: a task, a learner, and how it is evaluated."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple, get_type_hints

from nomad_agents.agent import Agent
from nomad_agents.deep import LEARNERS as DEEP
from nomad_agents.deep.training import require_budget
from nomad_agents.learners import (
    LEARNERS,
    DeepLearner,
    Learner,
    Lesson,
    ReactionLearner,
    Untaught,
)
from nomad_agents.paths import expanded
from nomad_agents.reactive_planner import FAITHFUL, ReactivePlanner, ReactivePlannerConfig
from nomad_agents.registry import AGENTS, SETTINGS, find_agent, find_config
from nomad_agents.studies.digest import digest
from nomad_agents.studies.runs import Row
from nomad_agents.sweeps.options import (
    AGENT,
    CONFIG,
    DECISIONS,
    MAX_DECISIONS,
    OBSERVATION,
    STARTS,
    TRAIN,
    Value,
    catalogue,
    sizes,
)
from nomad_agents.task_options import TaskOptions
from nomad_agents.training import TrainingConfig


class Settings(NamedTuple):
    """What the options of one run come to.

    Attributes
    ----------
    task : TaskOptions
        Where, and how the sensors err.
    agent : str
        Name of a learner, or file of a checkpoint.
    config, training : ReactivePlannerConfig, TrainingConfig
        Of the agents that have them.
    own : Any
        Settings of this agent alone; None if it has none.
    observation : str
        What a deep learner is shown.
    budget : int
        Decisions that it learns from.
    starts : str
        To evaluate from: how many, or a file.
    max_decisions : int
        Of an evaluated episode.
    """

    task: TaskOptions
    agent: str
    config: ReactivePlannerConfig
    training: TrainingConfig
    own: Any
    observation: str
    budget: int
    starts: str
    max_decisions: int

    def learner(self) -> Learner:
        """Return how the agent comes to be."""
        if self.agent in DEEP:
            return DeepLearner(self.agent, self.own)
        if self.agent == ReactivePlanner.name:
            return ReactionLearner(self.config, self.training)
        if self.agent in AGENTS:
            return Untaught(self.agent, self.config, self.own)
        return LEARNERS.get(self.agent) or Stored(self.agent)

    def variant(self) -> str:
        """Return which variant of the learner is meant; a configuration says itself what it is."""
        return self.observation if self.agent in DEEP else self.learner().variants[0]


class Stored(Learner):
    """An agent that a checkpoint file holds; it learns no more.

    Parameters
    ----------
    name : str
        Path of the file.
    """

    variants = ("",)
    learns = False

    def __init__(self, name: str) -> None:
        self.name = name

    def parameters(self, variant: str) -> Any:
        """Return what tells the file from others."""
        return digest(expanded(self.name))

    def learn(self, lesson: Lesson) -> tuple[Agent, Row]:
        """Return it as it is; errors as of `find_agent`."""
        with lesson.open() as env:
            return find_agent(self.name, env.scene.robot.layout, FAITHFUL), {}


def settle(values: Mapping[str, Value | None], seed: int) -> Settings:
    """Return what some options come to with a seed, all others being as usual.

    Options of other agents than the run's make no difference, nor do those that are None.

    Raises
    ------
    NomadError
        Values that make no sense.
    """
    known = catalogue()
    parts: dict[str, dict[str, Any]] = {part: {} for part in ("task", "run", "train", "config")}
    parts["own"] = {}
    for name, value in values.items():
        if value is not None:
            parts[known[name].part][name.removeprefix(TRAIN)] = value
    run = {name: parts["run"].get(name, known[name].usual) for name in _OF_RUNS}
    config = find_config(run[CONFIG])
    for name, value in parts["config"].items():
        config = _replaced(config, name, value)
    agent = run[AGENT]
    own = _own(agent, parts["own"])
    if own is not None and agent in DEEP:
        require_budget(run[DECISIONS], 0, seed, own)
    return Settings(
        TaskOptions(**parts["task"]),
        agent,
        config,
        TrainingConfig(seed, **parts["train"]),
        own,
        run[OBSERVATION],
        run[DECISIONS],
        run[STARTS],
        run[MAX_DECISIONS],
    )


_OF_RUNS = (AGENT, CONFIG, STARTS, MAX_DECISIONS, OBSERVATION, DECISIONS)


def _own(agent: str, values: Mapping[str, Any]) -> Any:
    """Return the settings of an agent alone, of values by ``AGENT.FIELD``."""
    usual = DEEP[agent]() if agent in DEEP else SETTINGS.get(agent)
    if usual is None:
        return None
    hints = get_type_hints(type(usual))
    found: dict[str, Any] = {}
    for name, value in values.items():
        owner, _, field = name.partition(".")
        if owner == agent:
            found[field] = sizes(value) if hints[field] == tuple[int, ...] else value
    return replace(usual, **found)


def _replaced(config: Any, name: str, value: Value) -> Any:
    """Return a configuration in which the field of a dotted name is another."""
    first, _, rest = name.partition(".")
    return replace(
        config, **{first: _replaced(getattr(config, first), rest, value) if rest else value}
    )
