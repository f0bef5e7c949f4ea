"""Bumpers that stick."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nomad_mj import BumperNoise, load
from nomad_mj.errors import ConfigError
from nomad_mj.tasks.bumpers import StickyBumpers
from nomad_mj.types import FloatArray

touches = st.lists(st.lists(st.booleans(), min_size=3, max_size=3), min_size=1, max_size=40)


def told(noise: BumperNoise, touched: FloatArray, seed: int = 0) -> FloatArray:
    bumpers = StickyBumpers(noise, touched.shape[1], np.random.default_rng(seed))
    return np.array([bumpers.tell(row) for row in touched])


@given(touches, st.integers(0, 6))
def test_a_bumper_reads_one_while_it_is_touched_and_for_so_long_after(
    pattern: list[list[bool]], steps: int
) -> None:
    touched = np.array(pattern, dtype=float)
    wanted = touched.copy()
    for step in range(len(touched)):
        wanted[step] = touched[max(step - steps, 0) : step + 1].max(axis=0)
    np.testing.assert_array_equal(told(BumperNoise(hold=0.05 * steps), touched), wanted)


@given(touches, st.integers(0, 2**32))
def test_what_always_sticks_stays_on_from_the_first_touch(
    pattern: list[list[bool]], seed: int
) -> None:
    touched = np.array(pattern, dtype=float)
    ever = np.maximum.accumulate(touched, axis=0)
    np.testing.assert_array_equal(told(BumperNoise(sticking=1.0), touched, seed), ever)


def test_bumpers_stick_as_often_as_asked_for_and_come_free_when_touched_again() -> None:
    touched = np.zeros((4, 4000))
    touched[0] = touched[2] = 1.0
    seen = told(BumperNoise(sticking=0.3), touched)
    for after in (1, 3):
        assert seen[after].mean() == pytest.approx(0.3, abs=0.03)
    assert seen[1][seen[3] > 0].mean() == pytest.approx(0.3, abs=0.05)  # each time anew


def test_in_a_room_a_touch_is_remembered_until_the_episode_ends() -> None:
    options = {"bumper_noise": BumperNoise(sticking=1.0), "ends_at_goal": False}
    with load("motor", "empty_room", task_kwargs=options) as env:
        for _ in range(2):
            step = env.reset(seed=0, start=(0.45, 5.0, math.pi))
            assert not step.observation["bumpers"].any()
            for _ in range(30):
                step = env.step((0.5, 0.0, 0.0))
            assert step.observation["bumpers"].any()
            for _ in range(30):
                step = env.step((-0.3, 0.0, 0.0))
            assert not env.physics.bumpers().any() and step.observation["bumpers"].any()


def test_path_finding_goes_on_with_a_bumper_that_sticks() -> None:
    options = {"bumper_noise": BumperNoise(sticking=1.0)}
    with load("path_finding", "empty_room", task_kwargs=options) as env:
        env.reset(seed=0, start=(0.45, 5.0, math.pi))
        for _ in range(30):
            env.motor.step((0.5, 0.0, 0.0))
        assert env.physics.bumpers().any()
        seen = [env.step((0.0, 1.0)).observation for _ in range(5)]
        assert all(each["bumpers"].any() for each in seen[1:])
        assert not env.physics.bumpers().any()
        assert sum(float(each["driven"]) for each in seen[1:]) > 1.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"hold": -0.1}, "bumper noise hold -0.1: must be 0 s or more"),
        ({"hold": math.nan}, "bumper noise hold nan: must be 0 s or more"),
        ({"sticking": 1.5}, "bumper noise sticking 1.5: must be in [0, 1]"),
    ],
)
def test_what_makes_no_sense_is_refused(options: dict[str, float], message: str) -> None:
    with pytest.raises(ConfigError) as caught:
        BumperNoise(**options)
    assert str(caught.value) == message
