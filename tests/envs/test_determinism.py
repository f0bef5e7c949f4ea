"""The same seed gives the same bits: again, after other episodes, and in another process."""

import hashlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import dm_env
import numpy as np
import pytest

from nomad_mj import MotorEnvironment, PathFinding, load
from nomad_mj.types import FloatArray

Env = MotorEnvironment | PathFinding
MOVES = {"motor": 40, "path_finding": 4}


@pytest.fixture(scope="module", params=MOVES)
def task(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def env(task: str) -> Iterator[Env]:
    made: Env = load(task)  # type: ignore[call-overload]
    yield made
    made.close()


def actions(env: Env, count: int, seed: int) -> FloatArray:
    spec = env.action_spec()
    return np.random.default_rng(seed).uniform(spec.minimum, spec.maximum, (count, *spec.shape))


def digest(steps: list[dm_env.TimeStep]) -> str:
    """Return a digest of every bit of these time steps."""
    told = hashlib.sha256()
    for step in steps:
        told.update(repr((int(step.step_type), step.reward, step.discount)).encode())
        for name, value in step.observation.items():
            told.update(name.encode() + np.asarray(value).tobytes())
    return told.hexdigest()


def episode(env: Env, task: str, seed: int | None, choice: int = 0) -> str:
    first = env.reset(seed=seed)
    return digest([first, *(env.step(action) for action in actions(env, MOVES[task], choice))])


def test_the_same_seed_gives_the_same_bits_whatever_came_before(env: Env, task: str) -> None:
    wanted = episode(env, task, 7)
    assert episode(env, task, 7) == wanted
    episode(env, task, 8, choice=1)
    env.reset(seed=3, start=(0.7, 9.2, 2.0))  # into the wall, and left in the middle
    env.step(env.action_spec().maximum * np.ones(env.action_spec().shape))
    assert episode(env, task, 7) == wanted
    assert episode(env, task, 8) != wanted


def test_the_nth_episode_after_a_seed_is_the_same_whatever_was_done_in_the_others(
    env: Env, task: str
) -> None:
    runs: list[list[str]] = []
    for choice in (0, 5):
        episode(env, task, 11, choice=choice)
        episode(env, task, None, choice=choice + 1)
        runs.append([episode(env, task, None), episode(env, task, None)])
    assert runs[0] == runs[1]
    assert runs[0][0] != runs[0][1]


def test_an_environment_made_with_a_seed_is_one_reset_to_it(env: Env, task: str) -> None:
    made: Env = load(task, task_kwargs={"random": 7})  # type: ignore[call-overload]
    first = made.reset()
    told = digest([first, *(made.step(a) for a in actions(made, MOVES[task], 0))])
    assert told == episode(env, task, 7)
    made.close()


def test_a_seed_sequence_serves_as_a_seed_and_is_not_used_up(env: Env, task: str) -> None:
    sequence = np.random.SeedSequence(5, spawn_key=(1, 2))
    firsts = [digest([env.reset(seed=sequence)]) for _ in range(2)]
    assert firsts[0] == firsts[1] != digest([env.reset(seed=5)])
    assert sequence.n_children_spawned == 0


def test_without_a_seed_two_environments_differ(task: str) -> None:
    made: list[Env] = [load(task) for _ in range(2)]  # type: ignore[call-overload]
    assert len({digest([env.reset()]) for env in made}) == 2
    for env in made:
        env.close()


def test_the_same_bits_come_out_of_another_process(env: Env, task: str) -> None:
    root = Path(__file__).resolve().parents[2]
    code = (
        f"import sys; sys.path[:0] = [{str(root)!r}, {str(Path(__file__).parent)!r}]\n"
        "from test_determinism import *\n"
        f"env = load({task!r}); print(episode(env, {task!r}, 7)); env.close()"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ran.stdout.strip() == episode(env, task, 7), ran.stderr
