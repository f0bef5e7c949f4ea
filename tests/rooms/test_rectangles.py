"""Rectangles cover cells, and nothing else."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from nomad_mj.rooms import merge_cells

GRIDS = arrays.array_shapes(min_dims=2, max_dims=2, max_side=12)
MASKS = GRIDS.flatmap(lambda shape: arrays.arrays(np.bool_, shape))
PAIRS = GRIDS.flatmap(lambda shape: st.tuples(*[arrays.arrays(np.bool_, shape)] * 2))


def painted(rectangles: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    times = np.zeros(shape, dtype=int)
    for row0, column0, row1, column1 in rectangles:
        times[row0:row1, column0:column1] += 1
    return times


@given(MASKS)
def test_they_cover_exactly_what_is_asked_for(must: np.ndarray) -> None:
    assert ((painted(merge_cells(must), must.shape) > 0) == must).all()


@given(PAIRS)
def test_they_stray_only_where_they_may_and_are_no_more(pair: tuple[np.ndarray, ...]) -> None:
    must, may = pair
    rectangles = merge_cells(must, may)
    times = painted(rectangles, must.shape)
    assert times[must].all() and not times[~must & ~may].any()
    assert len(rectangles) <= must.sum()


@given(MASKS)
def test_the_same_cells_give_the_same_rectangles(must: np.ndarray) -> None:
    assert (merge_cells(must) == merge_cells(must.copy())).all()


def test_a_full_grid_is_one_rectangle() -> None:
    assert merge_cells(np.ones((5, 9), dtype=bool)).tolist() == [[0, 0, 5, 9]]


def test_a_cross_is_two_rectangles_that_overlap() -> None:
    cross = np.zeros((7, 7), dtype=bool)
    cross[3] = cross[:, 3] = True
    assert merge_cells(cross).tolist() == [[0, 3, 7, 4], [3, 0, 4, 7]]
