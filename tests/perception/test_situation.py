import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from nomad_mj.perception import (
    GridSpec,
    SituationSpec,
    attraction_force,
    code_grid,
    code_signal,
    perceive,
)
from nomad_mj.types import FloatArray, RangeRing, SensorLayout

BEARINGS = tuple((np.arange(16) * np.pi / 8).tolist())
NOMAD = SensorLayout(
    0.265,
    (
        RangeRing("sonar", BEARINGS, np.pi / 12, 0.15, 6.5),
        RangeRing("infrared", BEARINGS, np.pi / 12, 0.0, 0.6),
    ),
)
SPEC = SituationSpec(circular=True)
specs = st.builds(
    SituationSpec,
    width=st.floats(0.11, 0.6),
    circular=st.booleans(),
    intensity_scale=st.floats(1, 10),
    use_intensity=st.booleans(),
)
goals = arrays(np.float64, 2, elements=st.floats(-10, 10))


def rounds(*shape: int) -> st.SearchStrategy[FloatArray]:
    seeds = st.integers(0, 2**32)
    return seeds.map(lambda seed: np.random.default_rng(seed).uniform(0.02, 3, (*shape, 32)))


@given(rounds(), st.floats(-10, 10), goals, specs)
def test_a_situation_is_26_numbers_in_the_unit_interval(
    ranges: FloatArray, heading: float, goal: FloatArray, spec: SituationSpec
) -> None:
    percept = perceive(ranges, heading, goal, NOMAD, spec)
    assert percept.situation.shape == (26,) == (spec.size,)
    assert percept.situation.dtype == np.float64
    assert (percept.situation >= 0).all() and (percept.situation <= 1).all()
    np.testing.assert_array_equal(percept.goal, goal)
    np.testing.assert_array_equal(percept.situation[10:], code_grid(percept.grid).ravel())
    np.testing.assert_array_equal(percept.situation[:10], attraction_force(goal, spec))


@given(
    rounds(2, 4),
    arrays(np.float64, (2, 4), elements=st.floats(-10, 10)),
    arrays(np.float64, (2, 4, 2), elements=st.floats(-10, 10)),
    specs,
)
def test_a_stack_is_perceived_as_its_parts_bit_for_bit(
    ranges: FloatArray, heading: FloatArray, goal: FloatArray, spec: SituationSpec
) -> None:
    stack = perceive(ranges, heading, goal, NOMAD, spec)
    for i in np.ndindex(2, 4):
        alone = perceive(ranges[i], float(heading[i]), goal[i], NOMAD, spec)
        for together, one in zip(stack, alone, strict=True):
            np.testing.assert_array_equal(np.asarray(together)[i], one)


@given(st.floats(0.01, 10), st.floats(-3.1, 3.1))
def test_direction_and_distance_of_the_goal_are_coded_apart(distance: float, angle: float) -> None:
    goal = distance * np.array([np.cos(angle), np.sin(angle)])
    coded = attraction_force(goal, SPEC)
    farther = attraction_force(2 * goal, SPEC)
    np.testing.assert_allclose(coded[:5], farther[:5], atol=1e-9)
    elsewhere = attraction_force(np.array([distance, 0.0]), SPEC)
    np.testing.assert_allclose(coded[5:], elsewhere[5:], atol=1e-9)


@given(st.floats(0.01, 10), st.floats(-3.1, 3.1), st.floats(-1e-6, 1e-6))
def test_a_small_change_of_direction_is_a_small_change_of_code(
    distance: float, angle: float, change: float
) -> None:
    ends = [distance * np.array([np.cos(a), np.sin(a)]) for a in (angle, angle + change)]
    here, there = (attraction_force(end, SPEC) for end in ends)
    np.testing.assert_allclose(here, there, atol=1e-5)


def test_on_the_circle_no_direction_is_a_border_and_on_the_segment_east_is() -> None:
    just_north_of_east, just_south = np.array([[1, 1e-9], [1, -1e-9]])
    for circular, jump in ((True, False), (False, True)):
        spec = SituationSpec(circular=circular)
        codes = [attraction_force(goal, spec) for goal in (just_north_of_east, just_south)]
        assert (np.abs(codes[0] - codes[1]).max() > 0.5) == jump


@given(st.floats(0, 20), st.floats(1, 10))
def test_the_attraction_is_the_inverse_exponential_of_the_distance(
    distance: float, scale: float
) -> None:
    spec = SituationSpec(intensity_scale=scale)
    coded = attraction_force(np.array([0.0, distance]), spec)[5:]
    np.testing.assert_allclose(coded, code_signal(np.exp(-distance / scale), spec.width))


def test_the_goal_itself_attracts_most() -> None:
    at_goal = attraction_force(np.zeros(2), SPEC)
    assert at_goal[9] == pytest.approx(1 - (0.1 / SPEC.width) ** 2)


@given(goals)
def test_without_intensity_the_distance_is_unknown(goal: FloatArray) -> None:
    assert not attraction_force(goal, SituationSpec(use_intensity=False))[5:].any()


@pytest.mark.parametrize(("cells", "size"), [(21, 26), (31, 46), (13, 14)])
def test_the_size_follows_the_grid(cells: int, size: int) -> None:
    spec = SituationSpec(grid=GridSpec(cells=cells))
    percept = perceive(np.ones(32), 0.0, np.ones(2), NOMAD, spec)
    assert percept.situation.shape == (spec.size,) == (size,)
    assert percept.grid.shape == (cells, cells)
