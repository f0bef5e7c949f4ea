"""The learners of this package: those that learn nothing, the reactive planner, deep ones."""

import copy
from contextlib import closing
from dataclasses import replace
from typing import Any

import cattrs

from nomad_agents.agent import Agent
from nomad_agents.deep import DeepAgent, DeepSettings
from nomad_agents.deep.environment import make_env
from nomad_agents.deep.extra import require_extra
from nomad_agents.deep.training import DeepTraining, require_budget, train_deep
from nomad_agents.learners.learner import Learner, Lesson
from nomad_agents.reactive_planner import CONFIGS, ReactivePlanner, ReactivePlannerConfig
from nomad_agents.registry import SETTINGS, find_config, make_agent
from nomad_agents.studies.learning import learn
from nomad_agents.studies.runs import Row
from nomad_agents.training import Training, TrainingConfig
from nomad_mj.errors import ConfigError
from nomad_mj.perception import OBSERVATIONS


class Untaught(Learner):
    """An agent of the registry that learns nothing.

    Parameters
    ----------
    name : str
        Of `registry.AGENTS`.
    config : ReactivePlannerConfig, optional
        In place of the variant's.
    own : optional
        In place of its entry in `registry.SETTINGS`.
    """

    variants = tuple(CONFIGS)
    learns = False

    def __init__(
        self, name: str, config: ReactivePlannerConfig | None = None, own: object = None
    ) -> None:
        self.name = name
        self._config = config
        self._own = SETTINGS.get(name) if own is None else own

    def parameters(self, variant: str) -> Any:
        """Return the configuration, and what the agent is told beside it."""
        config = cattrs.unstructure(self._config or find_config(variant))
        return config if self._own is None else {**config, "own": cattrs.unstructure(self._own)}

    def learn(self, lesson: Lesson) -> tuple[Agent, Row]:
        """Return it as it is."""
        with lesson.open() as env:
            layout = env.scene.robot.layout
        config = self._config or find_config(lesson.variant)
        return make_agent(self.name, layout, config, self._own), {}


class ReactionLearner(Learner):
    """The reactive planner, by protocol P0: passes over the room's starts, a test after each.

    What it knows from the beginning is its planner, which it asks where it knows no reaction.
    Checked unaided, it trusts the nearest reaction there instead.

    Parameters
    ----------
    config : ReactivePlannerConfig, optional
        In place of the variant's.
    training : TrainingConfig, optional
        When to give up, in place of a budget of decisions; the seed is the lesson's.
    """

    name = ReactivePlanner.name
    variants = tuple(CONFIGS)
    _MOST_DECISIONS = 50  # a start of the room; three passes at least, mostly more
    _MOST_PASSES = 40

    def __init__(
        self, config: ReactivePlannerConfig | None = None, training: TrainingConfig | None = None
    ) -> None:
        self._config = config
        self._training = training

    def parameters(self, variant: str) -> Any:
        """Return the configuration and when it gives up."""
        given_up: Any = {"decisions_a_start": self._MOST_DECISIONS, "passes": self._MOST_PASSES}
        if self._training is not None:
            given_up = cattrs.unstructure(self._training)
        return {**cattrs.unstructure(self._config or find_config(variant)), "given_up": given_up}

    def learn(self, lesson: Lesson) -> tuple[Agent, Row]:
        """Train until a test solves every start, or give up."""
        checks, latest, learnt_s = lesson.checks, Training(), 0.0
        with lesson.open() as env:
            config = self._config or find_config(lesson.variant)
            agent = ReactivePlanner(env.scene.robot.layout, config)

            def check(training: Training) -> None:
                spent = _spent(training) | {"sim_s": learnt_s}
                checks.take(copy.deepcopy(agent), unaided(agent), **spent)

            def watch(training: Training) -> None:
                nonlocal latest, learnt_s
                if not latest.testing:  # tests cost no time of learning, as checks do not
                    learnt_s += training.sim_s - latest.sim_s
                latest = replace(training)
                tested = training.next_start == 0 and not training.testing
                if checks.due(training.decisions) or tested:
                    check(training)

            check(latest)
            row, _ = learn(env, agent, self._until(lesson, len(env.scene.arena.starts)), watch)
            if latest.decisions > checks.latest:  # it gave up within a pass
                check(latest)
        spent = _spent(latest) | {"sim_s": learnt_s}
        row |= {f"learn_{name}": value for name, value in spent.items()}
        solved = row["learn_solved_all"]
        row["decisions_to_test"] = latest.decisions if solved else None
        row["sim_s_to_test"] = learnt_s if solved else None
        return agent, row

    def _until(self, lesson: Lesson, starts: int) -> TrainingConfig:
        """Return when it gives up in a room of so many starts."""
        if self._training is not None:
            return replace(self._training, seed=lesson.seed)
        most = min(lesson.budget, self._MOST_DECISIONS * starts)
        passes = self._MOST_PASSES
        return TrainingConfig(lesson.seed, max_passes=passes, max_decisions=most, whole_tests=False)


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

    def check_budget(self, budget: int) -> None:
        """Ask PPO for a rollout at least."""
        try:
            require_budget(budget, 0, 0, self._settings)
        except ConfigError as error:
            raise ConfigError(f"--budget {budget}, {self.name}: {error}") from None

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
