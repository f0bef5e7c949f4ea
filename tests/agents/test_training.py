"""Training by protocol P0: what is counted, same bits, interruptions."""

from dataclasses import asdict
from typing import Any

import numpy as np
import pytest
from nomad_agents import training as module
from nomad_agents.episode import Episode
from nomad_agents.reactive_planner import FAITHFUL, ReactivePlanner
from nomad_agents.training import Training, TrainingConfig, stream, train, training_report

from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError, StartError

Learnt = tuple[ReactivePlanner, Training]


def new(env: PathFinding) -> Learnt:
    return ReactivePlanner(env.scene.robot.layout, FAITHFUL), Training()


def state(learnt: Learnt) -> dict[str, Any]:
    """Return everything that a run must end with, real time aside, as comparable data."""
    agent, training = learnt
    arrays = {name: array.tolist() for name, array in agent.network.arrays().items()}
    return {**asdict(training), **arrays, "planned": agent.plannings, "wall_s": 0.0}


@pytest.fixture(scope="module")
def whole(env: PathFinding) -> Learnt:
    """Return a training that nothing interrupted."""
    agent, training = new(env)
    train(env, agent, TrainingConfig(seed=1), training)
    return agent, training


def test_training_solves_the_room(whole: Learnt) -> None:
    agent, training = whole
    assert training.done and (training.solved, training.tested) == (3, 3)
    assert training.bumper_contacts == 0 and training.plannings == agent.plannings
    assert 0 < training.reactions <= training.decisions and training.wall_s > 0


def test_the_same_seed_gives_the_same_bits(env: PathFinding, whole: Learnt) -> None:
    agent, training = new(env)
    train(env, agent, TrainingConfig(seed=1), training)
    assert state((agent, training)) == state(whole)


def test_another_seed_gives_others(env: PathFinding, whole: Learnt) -> None:
    agent, training = new(env)
    train(env, agent, TrainingConfig(seed=2, max_passes=1), training)
    assert not np.array_equal(agent.network.weights, whole[0].network.weights)


def test_interrupted_after_every_episode_it_ends_with_the_same_bits(
    env: PathFinding, whole: Learnt
) -> None:
    agent, training = new(env)

    def interrupt(_: Training) -> None:
        raise KeyboardInterrupt

    episodes = 0
    while not training.done:
        fresh, _ = new(env)  # as after loading a checkpoint: only what is saved is kept
        fresh.network.restore(agent.network.arrays())
        fresh.plannings = training.plannings
        agent, training = fresh, Training(**asdict(training))
        env.reset(seed=episodes)  # what was simulated in between must not matter
        with pytest.raises(KeyboardInterrupt):
            train(env, agent, TrainingConfig(seed=1), training, interrupt)
        episodes += 1
    assert episodes == 6 * training.passes
    assert state((agent, training)) == state(whole)


@pytest.mark.parametrize("decisions", [1, 30])
def test_interrupted_within_an_episode_that_episode_is_undone(
    env: PathFinding, whole: Learnt, monkeypatch: pytest.MonkeyPatch, decisions: int
) -> None:
    agent, training = new(env)
    learn, left = ReactivePlanner.learn, decisions

    def interrupt(*arguments: Any) -> None:
        nonlocal left
        learn(*arguments)
        left -= 1
        if not left:
            raise KeyboardInterrupt

    between: list[dict[str, Any]] = [state((agent, training))]
    monkeypatch.setattr(ReactivePlanner, "learn", interrupt)
    with pytest.raises(KeyboardInterrupt):
        train(
            env,
            agent,
            TrainingConfig(seed=1),
            training,
            lambda now: between.append(state((agent, now))),
        )
    assert state((agent, training)) == between[-1]
    monkeypatch.undo()
    train(env, agent, TrainingConfig(seed=1), training)
    assert state((agent, training)) == state(whole)


def test_a_pass_learns_from_every_start_then_tests_every_start(
    env: PathFinding, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls: list[tuple[Any, ...]] = []
    solved = iter([True, True, False] + [True] * 3)

    def episode(env: PathFinding, agent: ReactivePlanner, **given: Any) -> Episode:
        learning = given.get("explore") is not None
        calls.append((learning, given["start"], given["max_decisions"], given["seed"].spawn_key))
        reached = not learning and next(solved)
        return Episode(reached, 10, 7, 0, 2, 1, 3.5, 4.0, 0.1)

    monkeypatch.setattr(module, "run_episode", episode)
    agent, training = new(env)
    train(env, agent, TrainingConfig(episode_decisions=40, test_decisions=30), training)
    once = [(True, i, 40) for i in range(3)] + [(False, i, 30) for i in range(3)]
    assert [call[:3] for call in calls] == once * 2
    assert len({call[3] for call in calls}) == 12  # a stream each
    assert (training.decisions, training.reactions) == (60, 42)  # while learning alone
    assert (training.virtual_collisions, training.bumper_contacts) == (12, 6)
    assert training.sim_s == 12 * 3.5  # tests included
    report = training_report(env, agent, training)
    assert (report["solved"], report["starts"], report["passes"]) == (3, 3, 2)


@pytest.mark.parametrize(
    ("spent_in", "whole", "asked"),
    [(1, False, 1), (3, False, 1), (5, False, 1), (6, False, 1), (5, True, 3), (6, True, 6)],
)
def test_a_training_that_has_spent_its_decisions_is_asked_once_more_if_that_is_short(
    env: PathFinding, monkeypatch: pytest.MonkeyPatch, spent_in: int, whole: bool, asked: int
) -> None:
    episodes: list[bool] = []

    def episode(env: PathFinding, agent: ReactivePlanner, **given: Any) -> Episode:
        episodes.append(given.get("explore") is not None)
        return Episode(False, 10, 7, 0, 0, 0, 1.0, 1.0, 0.1)

    monkeypatch.setattr(module, "run_episode", episode)
    agent, training = new(env)
    config = TrainingConfig(max_decisions=10 * spent_in, whole_tests=whole)
    train(env, agent, config, training)
    assert episodes.count(True) == spent_in and training.decisions == 10 * spent_in
    assert episodes.count(False) == asked
    assert training.solved == 0 and not training.done


@pytest.mark.parametrize("spent_in", [2, 3])
def test_the_last_test_of_a_first_pass_ends_no_training(
    env: PathFinding, monkeypatch: pytest.MonkeyPatch, spent_in: int
) -> None:
    def episode(env: PathFinding, agent: ReactivePlanner, **given: Any) -> Episode:
        return Episode(True, 10, 7, 0, 0, 0, 1.0, 1.0, 0.1)

    monkeypatch.setattr(module, "run_episode", episode)
    agent, training = new(env)
    train(env, agent, TrainingConfig(max_decisions=10 * spent_in, whole_tests=False), training)
    assert (training.solved, training.tested, training.done) == (3, 3, False)
    assert training_report(env, agent, training)["passes"] == 1


def test_short_tests_leave_learning_as_it_is(env: PathFinding, whole: Learnt) -> None:
    agent, training = new(env)
    train(env, agent, TrainingConfig(seed=1, whole_tests=False), training)
    told = {"sim_s": whole[1].sim_s}  # of fewer tests
    assert training.sim_s < whole[1].sim_s
    assert state((agent, training)) | told == state(whole)


def test_a_short_test_ends_with_the_first_start_it_loses(
    env: PathFinding, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried: list[tuple[bool, int]] = []
    solved = iter([True, False] + [True] * 3)

    def episode(env: PathFinding, agent: ReactivePlanner, **given: Any) -> Episode:
        learning = given.get("explore") is not None
        tried.append((learning, given["start"]))
        return Episode(not learning and next(solved), 10, 7, 0, 0, 0, 1.0, 1.0, 0.1)

    monkeypatch.setattr(module, "run_episode", episode)
    agent, training = new(env)
    train(env, agent, TrainingConfig(whole_tests=False), training)
    learning = [(True, i) for i in range(3)]
    assert tried == [
        *learning,  # the test of the first pass would count for nothing
        *learning,
        *[(False, i) for i in range(2)],
        *learning,
        *[(False, i) for i in range(3)],
    ]
    assert training.done and (training.passes, training.solved) == (3, 3)


@pytest.mark.parametrize("passes", [1, 2])
def test_a_training_that_gives_up_counts_the_passes_it_made(
    env: PathFinding, monkeypatch: pytest.MonkeyPatch, passes: int
) -> None:
    lost = Episode(False, 10, 7, 0, 0, 0, 1.0, 1.0, 0.1)
    monkeypatch.setattr(module, "run_episode", lambda *_, **__: lost)  # pyright: ignore[reportUnknownLambdaType]
    agent, training = new(env)
    assert training_report(env, agent, training)["passes"] == 0
    train(env, agent, TrainingConfig(max_passes=passes), training)
    assert not training.done and training_report(env, agent, training)["passes"] == passes
    train(env, agent, TrainingConfig(max_passes=passes + 1), training)  # goes on, asked for more
    assert training_report(env, agent, training)["passes"] == passes + 1


def test_training_gives_up_after_so_many_decisions(env: PathFinding) -> None:
    agent, training = new(env)
    train(env, agent, TrainingConfig(max_decisions=4), training)
    made = training.decisions
    assert made >= 4 and not training.done and not training.testing
    train(env, agent, TrainingConfig(max_decisions=4), training)
    assert training.decisions == made


@pytest.mark.parametrize(
    "wrong",
    [
        {"seed": -1},
        {"max_passes": 0},
        {"max_decisions": -1},
        {"episode_decisions": 0},
        {"test_decisions": -3},
    ],
)
def test_senseless_limits_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ConfigError, match=f"^{next(iter(wrong))} -?[0-9]+: must be [01]"):
        TrainingConfig(**wrong)


def test_some_of_the_starts_are_trained_on_alone(env: PathFinding) -> None:
    agent = ReactivePlanner(env.scene.robot.layout, FAITHFUL)
    begun: list[list[float]] = []
    env.on_control_step = lambda: begun.append([*env.motor.task.start_pose[:2]])
    try:
        training = train(env, agent, TrainingConfig(starts=(2,)), Training())
    finally:
        env.on_control_step = None
    assert training.done and training.tested == 1
    assert np.unique(begun, axis=0).tolist() == [env.scene.arena.starts[2, :2].tolist()]


def test_a_start_that_there_is_not_is_refused(env: PathFinding) -> None:
    agent = ReactivePlanner(env.scene.robot.layout, FAITHFUL)
    with pytest.raises(StartError, match=r"^start 3: the room's are numbered 0 to 2$"):
        train(env, agent, TrainingConfig(starts=(0, 3)), Training())


def test_streams_differ_by_seed_and_by_key() -> None:
    keys = [(0, 0), (0, 1), (1, 0), (0, 0, 0), (0, 0, 1)]
    drawn = {np.random.default_rng(stream(*key)).integers(2**62) for key in keys}
    assert len(drawn) == len(keys)
