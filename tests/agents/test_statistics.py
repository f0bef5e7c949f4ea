"""Statistics over runs: laws that hold for any numbers, and one that is known."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nomad_agents.studies.statistics import Spread, spread

from nomad_mj.types import FloatArray

numbers = st.floats(-1e6, 1e6) | st.integers(-3, 3).map(float)
samples = st.lists(numbers | st.just(np.nan), max_size=12).map(np.array)
many_samples = st.lists(samples, min_size=1, max_size=3)


def same(one: Spread, other: Spread) -> bool:
    return bool(np.array_equal(np.array(one), np.array(other), equal_nan=True))


@settings(max_examples=60)
@given(many_samples)
def test_order_and_bounds(strata: list[FloatArray]) -> None:
    over = spread(strata)
    values = np.concatenate(strata)
    values = values[np.isfinite(values)]
    assert over.count == len(values)
    if not len(values):
        assert np.isnan(over[1:]).all()
        return
    slack = 1e-12 * max(1.0, float(np.abs(values).max()))
    assert values.min() <= over.q1 <= over.median <= over.q3 <= values.max()
    assert values.min() - slack <= over.iqm <= values.max() + slack
    if any(np.isfinite(each).sum() > 1 for each in strata):
        assert values.min() - slack <= over.low <= over.high <= values.max() + slack
    else:
        assert np.isnan([over.low, over.high]).all()


@settings(max_examples=30)
@given(many_samples)
def test_the_same_bits_again_and_missing_values_do_not_count(strata: list[FloatArray]) -> None:
    over = spread(strata)
    assert same(over, spread(strata))
    assert same(over, spread([np.append(each, [np.nan, np.inf]) for each in strata]))
    assert same(over, spread([*strata, np.empty(0)]))


@settings(max_examples=30)
@given(samples, st.integers(-100, 100), st.sampled_from([0.25, 2.0, 8.0]))
def test_moves_and_scales_with_the_values(values: FloatArray, by: int, times: float) -> None:
    values = np.round(values)  # so that sums are exact
    over, moved = spread([values]), spread([times * values + by])
    assert moved[1:] == pytest.approx([times * v + by for v in over[1:]], nan_ok=True, abs=1e-6)


def test_known_numbers() -> None:
    over = spread([np.array([100.0, 3, 1, 2, 4, 5, 6, -50])])
    assert over[:5] == pytest.approx((8, 1.75, 3.5, 5.25, 3.5))
    assert -50 < over.low < 3.5 < over.high < 100


def test_a_single_run_and_runs_that_agree() -> None:
    alone = spread([np.array([7.0])])
    assert alone[:5] == (1, 7, 7, 7, 7) and np.isnan([alone.low, alone.high]).all()
    assert spread([np.full(5, 7.0)]) == (5, 7, 7, 7, 7, 7, 7)


def test_a_stratum_keeps_its_share() -> None:
    apart = [np.zeros(10), np.full(10, 100.0)]
    stratified, pooled = spread(apart), spread([np.concatenate(apart)])
    assert (stratified.low, stratified.iqm, stratified.high) == (50, 50, 50)
    assert pooled.low < 40 and pooled.high > 60


def test_the_interval_holds_the_truth_about_as_often_as_it_says() -> None:
    rng = np.random.default_rng(0)
    held = 0
    for _ in range(100):
        over = spread([rng.normal(5, 2, 20)])  # symmetric: its interquartile mean is 5
        held += over.low <= 5 <= over.high
    assert 85 <= held <= 99
