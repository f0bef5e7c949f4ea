import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from nomad_mj.perception import code_grid, code_signal, pool
from nomad_mj.perception.coarse_coding import UNIT_CENTRES
from nomad_mj.types import FloatArray

signals = st.floats(0, 1)
widths = st.floats(0.11, 0.6)
grids = arrays(np.float64, (21, 21), elements=st.floats(0, 1))


@given(signals)
def test_a_grid_of_one_value_codes_to_that_value(value: float) -> None:
    coded = code_grid(np.full((21, 21), value))
    assert coded.shape == (4, 4)
    np.testing.assert_allclose(coded, value, atol=1e-12)


@given(grids)
def test_coding_is_linear_and_stays_between_the_extremes(grid: FloatArray) -> None:
    coded = code_grid(grid)
    assert coded.min() >= grid.min() - 1e-12 and coded.max() <= grid.max() + 1e-12
    np.testing.assert_allclose(code_grid(1 - grid), 1 - coded, atol=1e-12)


@given(grids, st.integers(0, 3))
def test_turning_and_mirroring_the_grid_does_so_to_its_code(grid: FloatArray, turns: int) -> None:
    np.testing.assert_allclose(
        code_grid(np.rot90(grid, turns)), np.rot90(code_grid(grid), turns), atol=1e-12
    )
    np.testing.assert_allclose(code_grid(grid[::-1]), code_grid(grid)[::-1], atol=1e-12)


@given(arrays(np.float64, (9, 9), elements=st.floats(0, 1)))
def test_pooling_takes_the_means_of_overlapping_squares(grid: FloatArray) -> None:
    pooled = pool(grid, 3, 2)
    assert pooled.shape == (4, 4)
    for i, j in np.ndindex(4, 4):
        square = grid[2 * i : 2 * i + 3, 2 * j : 2 * j + 3]
        assert pooled[i, j] == pytest.approx(square.mean())


@given(arrays(np.float64, (2, 3, 21, 21), elements=st.floats(0, 1)))
def test_a_stack_of_grids_is_coded_as_its_parts_bit_for_bit(grid: FloatArray) -> None:
    coded = code_grid(grid)
    for i in np.ndindex(2, 3):
        np.testing.assert_array_equal(coded[i], code_grid(grid[i]))
        np.testing.assert_array_equal(coded[i], code_grid(grid[i].copy()))


@given(signals, widths, st.booleans())
def test_units_answer_by_equation_1(signal: float, width: float, circular: bool) -> None:
    off = np.abs(signal - UNIT_CENTRES)
    if circular:
        off = np.minimum(off, 1 - off)
    wanted = np.where(off <= width, 1 - off**2 / width**2, 0)
    np.testing.assert_allclose(code_signal(signal, width, circular=circular), wanted, atol=1e-9)


@given(signals, widths)
def test_on_the_circle_both_ends_are_one_point(signal: float, width: float) -> None:
    coded = code_signal(signal, width, circular=True)
    np.testing.assert_allclose(code_signal(signal + 1, width, circular=True), coded, atol=1e-9)
    # A fifth of a turn further on, each unit says what the one before it said.
    further = code_signal((signal + 0.2) % 1, width, circular=True)
    np.testing.assert_allclose(further, np.roll(coded, 1), atol=1e-9)


def test_on_the_segment_the_ends_are_far_apart() -> None:
    assert not (code_signal(0.02, 0.35)[-1] or code_signal(0.98, 0.35)[0])
