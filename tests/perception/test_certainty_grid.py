"""Laws of the certainty grid, for any rings of sensors, against a slow and plain reading of it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from nomad_mj.perception import GridSpec, cell_centres, certainty_grid, code_grid
from nomad_mj.types import FloatArray, RangeRing, SensorLayout

SPEC = GridSpec()
UNIFORM = tuple((np.arange(16) * math.tau / 16).tolist())
NOMAD = SensorLayout(
    0.265,
    (
        RangeRing("sonar", UNIFORM, math.radians(15), 0.15, 6.5),
        RangeRing("infrared", UNIFORM, math.radians(15), 0.0, 0.6),
    ),
)
LIDAR = SensorLayout(
    0.2, (RangeRing("lidar", tuple((np.arange(72) * math.tau / 72).tolist()), 0.0436, 0.0, 8.0),)
)
EIGHT = SensorLayout(
    0.05, (RangeRing("ir", tuple((np.arange(8) * math.tau / 8).tolist()), 0.3927, 0.0, 0.8),)
)
UNEVEN = SensorLayout(0.3, (RangeRing("sonar", (-1.5, -0.3, 0.0, 0.31, 1.5), 0.2, 0.1, 3.0),))
NARROW_FIRST = SensorLayout(0.265, NOMAD.rings[::-1])  # the ring that sees all cells comes last
LAYOUTS = (NOMAD, LIDAR, EIGHT, UNEVEN, NARROW_FIRST)

headings = st.floats(-10, 10)
rings = st.builds(
    RangeRing,
    name=st.just("ring"),
    bearings=st.lists(st.floats(-math.pi, math.pi), min_size=1, max_size=12).map(tuple),
    half_angle=st.floats(0.02, 0.7),
    min_range=st.floats(0, 0.2),
    max_range=st.floats(0.3, 8),
)
layouts = st.one_of(
    st.sampled_from(LAYOUTS),
    st.builds(
        SensorLayout,
        radius=st.floats(0.05, 0.4),
        rings=st.lists(rings, min_size=1, max_size=2).map(tuple),
    ),
)
specs = st.builds(
    GridSpec,
    cells=st.sampled_from([5, 11, 21]),
    resolution=st.floats(0.1, 0.3),
    perception_range=st.floats(0.5, 4),
    edge_certainty=st.floats(0, 1),
    unseen=st.floats(0, 1),
)


@st.composite
def readings(draw: st.DrawFn, layout: SensorLayout, count: int = 1) -> FloatArray:
    """Draw rounds of readings (count, sensors) within the limits of each ring."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    low = np.repeat([r.min_range for r in layout.rings], [len(r.bearings) for r in layout.rings])
    high = np.repeat([r.max_range for r in layout.rings], [len(r.bearings) for r in layout.rings])
    ranges = rng.uniform(low, high, (count, layout.count))
    return np.where(rng.random(ranges.shape) < draw(st.floats(0, 0.9)), high, ranges)


def slow_grid(
    ranges: FloatArray, heading: float, layout: SensorLayout, spec: GridSpec
) -> FloatArray:
    """Return the grid by the definition, NaN where a cone's edge makes it a matter of rounding."""
    sensors = [(bearing, ring) for ring in layout.rings for bearing in ring.bearings]
    grid = np.full((spec.cells, spec.cells), spec.unseen)
    for i, j in np.ndindex(grid.shape):
        x = (j - spec.cells // 2) * spec.resolution
        y = (i - spec.cells // 2) * spec.resolution
        distance, told = math.hypot(x, y), list[float]()
        if distance <= layout.radius:
            grid[i, j] = 0.0
            continue
        for reading, (bearing, ring) in zip(ranges.tolist(), sensors, strict=True):
            off = abs(math.remainder(math.atan2(y, x) - heading - bearing, math.tau))
            if abs(off - ring.half_angle) < math.radians(0.3):
                told = [math.nan]
                break
            if off > ring.half_angle or distance > ring.max_range + layout.radius:
                continue
            missed = reading >= min(ring.max_range, spec.perception_range)
            behind = distance - reading - layout.radius
            occupied = 0.0 if missed else min(max(behind * 2 / spec.resolution + 1, 0.0), 1.0)
            share = off / ring.half_angle
            told.append(occupied * (1 - (1 - spec.edge_certainty) * share**2))
        grid[i, j] = min(told, default=spec.unseen)
    return grid


@settings(max_examples=60)
@given(st.data(), layouts, specs, headings)
def test_it_is_what_the_definition_says(
    data: st.DataObject, layout: SensorLayout, spec: GridSpec, heading: float
) -> None:
    ranges = data.draw(readings(layout))[0]
    grid = certainty_grid(ranges, heading, layout, spec)
    slow = slow_grid(ranges, heading, layout, spec)
    sure = ~np.isnan(slow)
    # Bearings are rounded to a quarter of a degree, here and in the cones' tables.
    narrowest = min(ring.half_angle for ring in layout.rings)
    assert np.abs(grid - slow)[sure].max(initial=0) <= 2 * math.radians(0.3) / narrowest + 1e-9


@given(st.data(), layouts, specs, headings)
def test_all_cells_are_probabilities(
    data: st.DataObject, layout: SensorLayout, spec: GridSpec, heading: float
) -> None:
    grid = certainty_grid(data.draw(readings(layout))[0], heading, layout, spec)
    assert grid.shape == (spec.cells, spec.cells)
    assert (grid >= 0).all() and (grid <= 1).all()


@given(st.data(), layouts, specs)
def test_a_stack_is_handled_as_its_parts_bit_for_bit(
    data: st.DataObject, layout: SensorLayout, spec: GridSpec
) -> None:
    ranges = data.draw(readings(layout, 6)).reshape(2, 3, -1)
    heading = data.draw(arrays(np.float64, (2, 3), elements=headings))
    grid = certainty_grid(ranges, heading, layout, spec)
    for i in np.ndindex(2, 3):
        np.testing.assert_array_equal(
            grid[i], certainty_grid(ranges[i], float(heading[i]), layout, spec)
        )
    same = certainty_grid(ranges, 0.3, layout, spec)
    np.testing.assert_array_equal(same[1, 2], certainty_grid(ranges[1, 2], 0.3, layout, spec))


@pytest.mark.parametrize("threads", [1, 3])
def test_hundreds_on_threads_are_handled_as_each_by_itself(threads: int) -> None:
    rng = np.random.default_rng(0)
    ranges = rng.uniform(0.1, 4.0, (700, NOMAD.count))
    turns = rng.uniform(-4.0, 4.0, 700)
    grids = certainty_grid(ranges, turns, NOMAD, SPEC, threads)
    for i in (0, 1, 255, 256, 511, 512, 699):
        one = certainty_grid(ranges[i], float(turns[i]), NOMAD, SPEC)
        np.testing.assert_array_equal(grids[i], one)
        np.testing.assert_array_equal(code_grid(grids, threads)[i], code_grid(one))


@pytest.mark.parametrize("off", [-0.002, -0.001, 0.0, 0.001, 0.002])
@pytest.mark.parametrize("turns", [-2, 0, 1])
def test_what_is_straight_behind_is_found_from_any_heading(turns: int, off: float) -> None:
    # A cone of half a degree: whoever looks up a neighbouring direction does not see it.
    one = SensorLayout(0.2, (RangeRing("one", (0.0,), math.radians(0.25), 0.0, 6.0),))
    grid = certainty_grid(np.array([1.0]), turns * math.tau - math.pi + off, one, SPEC)
    assert (grid[10, :9] != SPEC.unseen).all() and (grid[10, 12:] == SPEC.unseen).all()


@given(readings(NOMAD), headings)
def test_the_order_of_rings_does_not_matter(ranges: FloatArray, heading: float) -> None:
    grid = certainty_grid(ranges[0], heading, NOMAD, SPEC)
    turned = np.concatenate([ranges[0, 16:], ranges[0, :16]])
    np.testing.assert_array_equal(certainty_grid(turned, heading, NARROW_FIRST, SPEC), grid)


@given(readings(NOMAD), st.integers(-3000, 3000), st.sampled_from((-1000, -3, -1, 1, 3, 1000)))
def test_whole_turns_do_not_matter(ranges: FloatArray, milliradians: int, turns: int) -> None:
    heading = milliradians / 1000  # no cell is then at the edge of a quarter of a degree
    grid = certainty_grid(ranges[0], heading, NOMAD, SPEC)
    again = certainty_grid(ranges[0], heading + turns * math.tau, NOMAD, SPEC)
    np.testing.assert_array_equal(again, grid)


@given(st.data(), layouts, headings)
def test_a_robot_turned_by_90_degrees_turns_the_grid(
    data: st.DataObject, layout: SensorLayout, heading: float
) -> None:
    ranges = data.draw(readings(layout))[0]
    grid = certainty_grid(ranges, heading, layout, SPEC)
    turned = certainty_grid(ranges, heading + math.pi / 2, layout, SPEC)
    # Rows run along y, upwards: with the rows reversed it looks as on paper.
    np.testing.assert_allclose(turned[::-1], np.rot90(grid[::-1]), atol=1e-9)


@given(st.data(), st.sampled_from([0, 1, 2, 3]), headings)
def test_readings_moved_round_the_ring_turn_the_grid_likewise(
    data: st.DataObject, quarters: int, heading: float
) -> None:
    ranges = data.draw(readings(NOMAD))[0]
    moved = np.roll(ranges.reshape(2, 16), 4 * quarters, axis=1).ravel()
    grid = certainty_grid(ranges, heading, NOMAD, SPEC)
    turned = certainty_grid(moved, heading, NOMAD, SPEC)
    np.testing.assert_allclose(turned[::-1], np.rot90(grid[::-1], quarters), atol=1e-9)


@given(st.data())
def test_a_mirrored_world_mirrors_the_grid(data: st.DataObject) -> None:
    ranges = data.draw(readings(NOMAD))[0]
    mirrored = ranges.reshape(2, 16)[:, -np.arange(16)].ravel()
    grid = certainty_grid(ranges, 0.0, NOMAD, SPEC)
    np.testing.assert_allclose(certainty_grid(mirrored, 0.0, NOMAD, SPEC), grid[::-1], atol=1e-9)


@given(st.data(), layouts, specs, headings)
def test_a_nearer_reading_never_empties_a_cell(
    data: st.DataObject, layout: SensorLayout, spec: GridSpec, heading: float
) -> None:
    one, other = data.draw(readings(layout, 2))
    near = certainty_grid(np.minimum(one, other), heading, layout, spec)
    assert (near >= certainty_grid(one, heading, layout, spec)).all()
    assert (near >= certainty_grid(other, heading, layout, spec)).all()


@pytest.mark.parametrize("layout", LAYOUTS)
def test_where_all_miss_all_in_reach_is_empty_and_the_rest_unseen(layout: SensorLayout) -> None:
    misses = np.concatenate([[ring.max_range] * len(ring.bearings) for ring in layout.rings])
    grid = certainty_grid(misses, 0.0, layout, replace(SPEC, unseen=0.25))
    assert set(np.unique(grid)) <= {0.0, 0.25}
    reach = max(ring.max_range for ring in layout.rings) + layout.radius
    beyond = np.hypot(*np.moveaxis(cell_centres(SPEC), -1, 0)) > reach
    assert (grid[beyond] == 0.25).all()


@pytest.mark.parametrize("layout", [NOMAD, LIDAR, EIGHT])
@given(distance=st.floats(0.05, 0.55), heading=headings)
def test_it_is_empty_before_a_round_wall_and_occupied_from_it_on(
    layout: SensorLayout, distance: float, heading: float
) -> None:
    grid = certainty_grid(np.full(layout.count, distance), heading, layout, SPEC)
    cells = np.hypot(*np.moveaxis(cell_centres(SPEC), -1, 0)) - layout.radius
    reach = min(max(ring.max_range for ring in layout.rings), SPEC.perception_range)
    before = cells < distance - SPEC.resolution / 2
    behind = (cells >= distance) & (cells <= reach)
    covered = grid != SPEC.unseen
    assert (grid[before & covered] == 0).all()
    assert (grid[behind & covered] >= SPEC.edge_certainty).all()


def test_the_middle_of_a_cone_is_surer_than_its_edge() -> None:
    one = SensorLayout(0.2, (RangeRing("sonar", (0.0,), math.radians(15), 0.0, 5.0),))
    grid = certainty_grid(np.array([1.0]), 0.0, one, SPEC)
    row = grid[:, 17]  # 1.4 m ahead
    assert row[10] == 1.0
    assert list(row[10:13]) == sorted(row[10:13], reverse=True)
    assert row[8:13].min() >= SPEC.edge_certainty
    assert (row[[0, 20]] == SPEC.unseen).all()


def test_cells_are_where_they_are_said_to_be() -> None:
    centres = cell_centres(SPEC)
    assert centres.shape == (21, 21, 2) and centres.dtype == np.float64
    np.testing.assert_allclose(centres[10, 10], [0, 0])
    np.testing.assert_allclose(centres[0, 20], [2.0, -2.0])
