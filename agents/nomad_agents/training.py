"""Training by protocol P0: passes over all starts of a room, a greedy test after each.

Training ends when a test solves every start, that is, reaches the goal from it; the test of the
first pass does not count, since under noise one can be passed by luck. Every episode has its own
streams of random numbers, derived from the seed, the pass and the start, so that training can be
interrupted between any two episodes and go on to the same bits.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from nomad_agents.episode import Watcher, run_episode
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError, StartError

_LEARN, _TEST, _EXPLORE = range(3)  # kinds of streams


@dataclass(frozen=True)
class TrainingConfig:
    """How long to train.

    Attributes
    ----------
    seed : int
        Of all randomness.
    min_passes : int
        Make so many passes at least.
    max_passes : int
        Give up after so many passes.
    max_decisions : int
        Give up after so many decisions, at the end of an episode; where tests are short, with a
        last one. 0 for no limit.
    episode_decisions, test_decisions : int
        A learning episode, a test episode is given up after so many decisions.
    starts : tuple of int
        Numbers of the room's starts to train on; all if empty.
    whole_tests : bool
        Whether a test tries every start, to tell how many are solved. Else it ends with the first
        that is not, and before `min_passes` there is none: learning goes on to the same bits, in
        little more than half of the time.
    """

    seed: int = 0
    min_passes: int = 2
    max_passes: int = 100
    max_decisions: int = 0
    episode_decisions: int = 100
    test_decisions: int = 50
    starts: tuple[int, ...] = ()
    whole_tests: bool = True

    def __post_init__(self) -> None:
        if self.seed < 0:
            raise ConfigError(f"seed {self.seed}: must be 0 or more")
        if self.max_decisions < 0:
            raise ConfigError(f"max_decisions {self.max_decisions}: must be 0 (no limit) or more")
        for name in ("min_passes", "max_passes", "episode_decisions", "test_decisions"):
            if getattr(self, name) < 1:
                raise ConfigError(f"{name} {getattr(self, name)}: must be 1 or more")

    def chosen(self, starts: int) -> tuple[int, ...]:
        """Return the numbers of the starts to train on, in a room that has so many.

        Raises
        ------
        StartError
            A number that no start of the room has.
        """
        for start in self.starts:
            if not 0 <= start < starts:
                raise StartError(f"start {start}: the room's are numbered 0 to {starts - 1}")
        return self.starts or tuple(range(starts))


@dataclass
class Training:
    """How far a training is.

    Attributes
    ----------
    passes : int
        Passes begun; after a test that lost a start, the next one counts.
    testing : bool
        Whether the test of this pass is under way.
    next_start : int
        The start that comes next in this pass or test.
    solved, tested : int
        Starts solved and tried in the newest test.
    decisions, reactions, plannings, virtual_collisions, bumper_contacts : int
        While learning.
    sim_s, wall_s : float
        Simulated and real time, tests included [s].
    done : bool
        Whether a test has solved every start.
    """

    passes: int = 1
    testing: bool = False
    next_start: int = 0
    solved: int = 0
    tested: int = 0
    decisions: int = 0
    reactions: int = 0
    plannings: int = 0
    virtual_collisions: int = 0
    bumper_contacts: int = 0
    sim_s: float = 0.0
    wall_s: float = 0.0
    done: bool = False


def stream(seed: int, *key: int) -> np.random.SeedSequence:
    """Return the seed of one stream of random numbers among those of `seed`."""
    return np.random.SeedSequence(seed, spawn_key=key)


def test_stream(config: TrainingConfig, passes: int, place: int) -> np.random.SeedSequence:
    """Return the seed of a test episode: after so many passes, from the start at this place."""
    return stream(config.seed, _TEST, passes, place)


def train(
    env: PathFinding,
    agent: ReactivePlanner,
    config: TrainingConfig,
    training: Training,
    after_episode: Callable[[Training], None] | None = None,
    watch: Watcher | None = None,
) -> Training:
    """Train until done or given up; `training` says from where on, and is brought up to date.

    What is raised within an episode, Ctrl-C too, leaves both as they were before that episode.

    Parameters
    ----------
    env, agent
        Of the same robot; both are changed.
    config, training
        How long to train; how far it is.
    after_episode : callable, optional
        Called after each episode: to show progress, to save; what it raises ends the training
        between two episodes.
    watch : callable, optional
        Looks on while learning, as of `run_episode`.
    """
    starts = config.chosen(len(env.scene.arena.starts))
    while not training.done and training.passes <= config.max_passes:
        spent = config.max_decisions and training.decisions >= config.max_decisions
        if spent and not training.testing:
            if config.whole_tests or (training.tested and not training.next_start):
                break
            _begin_last_test(training)
        began = time.perf_counter()
        before = replace(training), agent.network.arrays(), agent.plannings
        try:
            if training.testing:
                _test(env, agent, config, training, starts)
            else:
                _learn(env, agent, config, training, starts, watch)
            _advance(training, len(starts), config)
        except BaseException:  # half an episode learnt would not go on to the same bits
            vars(training).update(vars(before[0]))
            agent.network.restore(before[1])
            agent.plannings = before[2]
            raise
        training.wall_s += time.perf_counter() - began
        if after_episode is not None:
            after_episode(training)
    return training


def _begin_last_test(training: Training) -> None:
    """Let what it knows now be tested, its decisions being spent.

    Before `min_passes` a pass ends without a test; this is that pass's: the next has not begun.
    """
    training.passes -= not training.next_start
    training.testing, training.next_start = True, 0


def _learn(
    env: PathFinding,
    agent: ReactivePlanner,
    config: TrainingConfig,
    training: Training,
    starts: tuple[int, ...],
    watch: Watcher | None,
) -> None:
    place = (training.passes, training.next_start)
    episode = run_episode(
        env,
        agent,
        seed=stream(config.seed, _LEARN, *place),
        start=starts[training.next_start],
        explore=np.random.default_rng(stream(config.seed, _EXPLORE, *place)),
        max_decisions=config.episode_decisions,
        watch=watch,
    )
    training.decisions += episode.decisions
    training.reactions += episode.reactions
    training.virtual_collisions += episode.virtual_collisions
    training.bumper_contacts += episode.bumper_contacts
    training.plannings = agent.plannings
    training.sim_s += episode.duration


def _test(
    env: PathFinding,
    agent: ReactivePlanner,
    config: TrainingConfig,
    training: Training,
    starts: tuple[int, ...],
) -> None:
    if training.next_start == 0:
        training.solved = training.tested = 0
    episode = run_episode(
        env,
        agent,
        seed=test_stream(config, training.passes, training.next_start),
        start=starts[training.next_start],
        max_decisions=config.test_decisions,
    )
    training.solved += episode.reached
    training.tested += 1
    training.sim_s += episode.duration


def _advance(training: Training, starts: int, config: TrainingConfig) -> None:
    """Go on to the next start, to the test, or to the next pass."""
    training.next_start += 1
    failed = training.testing and training.solved < training.tested
    if training.next_start < starts and (config.whole_tests or not failed):
        return
    training.next_start = 0
    enough = training.passes >= config.min_passes
    if not training.testing and (enough or config.whole_tests):
        training.testing = True
        return
    training.done = training.testing and training.solved == starts and enough
    training.testing = False
    training.passes += not training.done


def training_report(env: PathFinding, agent: ReactivePlanner, training: Training) -> dict[str, Any]:
    """Return what `nomad-mj train --json` prints."""
    # Given up after a test, the training stands before a pass that it never began.
    waiting = not (training.done or training.testing or training.next_start)
    return {
        "solved": training.solved,
        "starts": len(env.scene.arena.starts),
        "reactions": training.reactions,
        "plannings": training.plannings,
        "virtual_collisions": training.virtual_collisions,
        "bumper_contacts": training.bumper_contacts,
        "categories": len(agent.network.value),
        "exemplars": len(agent.network.category),
        "passes": training.passes - waiting,
        "wall_s": round(training.wall_s, 3),
        "sim_s": round(training.sim_s, 3),
    }
