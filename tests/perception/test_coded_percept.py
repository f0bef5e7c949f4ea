"""What networks are shown: bounded numbers, the same wherever the world is turned to."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nomad_mj.geometry import rotate
from nomad_mj.perception import (
    OBSERVATIONS,
    Observation,
    Percept,
    SituationSpec,
    code_percept,
    coded_size,
    perceive,
)
from nomad_mj.types import RangeRing, SensorLayout

BEARINGS = tuple((np.arange(8) * np.pi / 4).tolist())
LAYOUT = SensorLayout(
    0.2,
    (
        RangeRing("sonar", BEARINGS, 0.2, 0.15, 6.5),
        RangeRing("infrared", BEARINGS[:3], 0.1, 0.0, 0.6),
    ),
)
SPEC = SituationSpec()
LONGEST = np.array([6.5] * 8 + [0.6] * 3)
shares = st.lists(st.floats(0, 1), min_size=11, max_size=11)
angles = st.floats(-7, 7)
places = st.tuples(st.floats(-9, 9), st.floats(-9, 9))


def see(share: list[float], heading: float, goal: tuple[float, float]) -> Percept:
    return perceive(np.array(share) * LONGEST, heading, np.array(goal), LAYOUT, SPEC)


@pytest.mark.parametrize("observation", OBSERVATIONS)
@given(share=shares, heading=angles, goal=places)
def test_numbers_are_bounded_and_as_many_as_told(
    observation: Observation, share: list[float], heading: float, goal: tuple[float, float]
) -> None:
    shown = code_percept(see(share, heading, goal), LAYOUT, observation)
    assert shown.shape == (coded_size(LAYOUT, observation, SPEC.size),)
    assert shown.dtype == np.float32 and np.abs(shown).max() <= 1
    assert shown.min() >= (0 if observation == "situation" else -1)


@given(share=shares, heading=angles, goal=places, turn=angles)
def test_ranges_do_not_tell_how_the_world_is_turned(
    share: list[float], heading: float, goal: tuple[float, float], turn: float
) -> None:
    one = see(share, heading, goal)
    other = see(share, heading + turn, tuple(rotate(goal, turn).tolist()))
    if np.hypot(*goal) > 1e-6:  # at the goal there is no direction to it
        assert code_percept(one, LAYOUT, "ranges") == pytest.approx(
            code_percept(other, LAYOUT, "ranges"), abs=1e-5
        )


def test_ranges_are_shares_and_then_the_goal_as_the_sensors_have_it() -> None:
    share = np.linspace(0, 1, 11)
    shown = code_percept(see(share.tolist(), np.pi / 2, (0.0, 5.0)), LAYOUT, "ranges")
    assert shown == pytest.approx([*share, 1.0, 0.0, np.exp(-1)])
    left = code_percept(see(share.tolist(), 0.0, (0.0, 5.0)), LAYOUT, "ranges")
    assert left[-3:] == pytest.approx([0.0, 1.0, np.exp(-1)], abs=1e-6)


@pytest.mark.parametrize("observation", OBSERVATIONS)
def test_many_percepts_at_once_are_the_same_as_one_by_one(observation: Observation) -> None:
    rng = np.random.default_rng(0)
    ranges, headings = rng.random((20, 11)) * LONGEST, rng.uniform(-4, 4, 20)
    goals = rng.uniform(-5, 5, (20, 2))
    together = code_percept(perceive(ranges, headings, goals, LAYOUT, SPEC), LAYOUT, observation)
    for number, row in enumerate(together):
        one = perceive(ranges[number], headings[number], goals[number], LAYOUT, SPEC)
        assert np.array_equal(row, code_percept(one, LAYOUT, observation))
