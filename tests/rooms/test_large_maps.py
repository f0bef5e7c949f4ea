"""Measured maps, ragged and full of things, become few shapes near to what the map shows."""

import math
import time
from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from office import RESOLUTION, office
from scipy import ndimage
from shapely import affinity

from nomad_mj.arenas import FloorPlan
from nomad_mj.rooms import (
    FREE,
    OCCUPIED,
    UNKNOWN,
    Box,
    Cylinder,
    Occupancy,
    Polygon,
    furnish,
    room_of_map,
    to_mjcf,
)
from nomad_mj.rooms.islands import fit_islands
from nomad_mj.rooms.places import floor_plan
from nomad_mj.rooms.smooth import straighten, without_specks
from nomad_mj.scene import build_scene

MASKS = arrays.array_shapes(min_dims=2, max_dims=2, max_side=16).flatmap(
    lambda shape: arrays.arrays(np.bool_, shape)
)


def test_a_ragged_office_takes_few_shapes_that_stand_where_the_map_says() -> None:
    grid = office()
    room = room_of_map(grid, "office", goal=(1.6, 4.4))
    assert len(room.walls) < 80 and len(room.obstacles) <= 40
    assert sum(isinstance(shape, Cylinder) for shape in room.obstacles) == 20
    stands = shapely.union_all(floor_plan(room).footprints)
    shapely.prepare(stands)
    rows, columns = np.indices(grid.cells.shape)
    places = grid.to_world(np.stack([columns, rows], axis=-1) + 0.5)
    there = shapely.contains_xy(stands, places[..., 0], places[..., 1])
    outside = np.asarray(ndimage.distance_transform_edt(grid.cells != OCCUPIED))
    assert outside[there].max() <= 2  # a gap one cell wide is filled, and a notch beside it
    seen = np.asarray(ndimage.binary_dilation(grid.cells == FREE, np.ones((3, 3))), dtype=np.bool_)
    off = shapely.distance(stands, shapely.points(places[seen & (grid.cells == OCCUPIED)]))
    assert np.max(off) < 2 * RESOLUTION


def test_of_a_large_office_only_what_is_near_a_robot_is_simulated(tmp_path: Path) -> None:
    began = time.process_time()
    path = tmp_path / "office.xml"
    path.write_text(to_mjcf(furnish(room_of_map(office(1000), "office"), starts=1)))
    scene = build_scene(path, "nomad200")
    assert time.process_time() - began < 10
    assert scene.model.ngeom > 600
    assert scene.simulated().ngeom < 100


@given(MASKS)
def test_straight_edges_move_by_a_cell_at_most(mask: np.ndarray) -> None:
    """What changes has a side in common with a cell of the other kind; what is thin stays."""
    changed = straighten(mask) != mask
    other = np.logical_and(ndimage.binary_dilation(mask), ndimage.binary_dilation(~mask))
    assert not (changed & ~other).any()
    thick = np.asarray(ndimage.binary_opening(mask, np.ones((4, 1))), dtype=np.bool_)
    thick |= np.asarray(ndimage.binary_opening(mask, np.ones((1, 4))), dtype=np.bool_)
    thin = mask & ~thick
    assert not (changed & thin).any()


def test_bumps_and_notches_go_and_corners_stay() -> None:
    mask = np.zeros((12, 30), dtype=bool)
    mask[5:, 3:27] = True
    wanted = mask.copy()
    mask[4, 8:13] = True
    mask[5, 18:20] = False
    assert (straighten(mask) == wanted).all()
    assert (straighten(wanted) == wanted).all()


def test_only_small_unknown_spots_are_noise() -> None:
    cells = np.full((20, 20), FREE)
    cells[3:5, 3:5] = cells[10:13, 10:12] = UNKNOWN
    cells[7, 3], cells[15, 15], cells[15, 16] = UNKNOWN, UNKNOWN, OCCUPIED
    free = without_specks(cells == FREE, cells == OCCUPIED)
    assert free[3:5, 3:5].all() and free[7, 3]
    assert not free[10:13, 10:12].any() and not free[15, 15:17].any()


@settings(deadline=None, max_examples=40)
@given(
    st.sampled_from(["disc", "box", "hexagon"]),
    st.floats(4, 14),
    st.floats(0.3, 1),
    st.floats(0, math.pi),
    st.tuples(st.floats(0, 1), st.floats(0, 1)),
)
def test_a_thing_drawn_on_a_map_is_found_again(
    kind: str, size: float, slim: float, turn: float, shift: tuple[float, float]
) -> None:
    rows, columns = np.indices((40, 40)) + 0.5
    x, y = columns - 20 - shift[0], rows - 20 - shift[1]
    x, y = math.cos(turn) * x + math.sin(turn) * y, math.cos(turn) * y - math.sin(turn) * x
    drawn = {
        "disc": np.hypot(x, y) < size,
        "box": (np.abs(x) < size) & (np.abs(y) < max(2.0, slim * size)),
        "hexagon": np.maximum(np.abs(x), np.abs(x) / 2 + np.abs(y) * math.sqrt(0.75)) < size,
    }[kind]
    (shape,), shown = fit_islands(np.pad(~drawn, 1))
    assert (shown[1:-1, 1:-1] == drawn).all()
    if isinstance(shape, Cylinder):
        found = shapely.Point(shape.x - 1, shape.y - 1).buffer(shape.radius)
    elif isinstance(shape, Box):
        box = shapely.box(-shape.length / 2, -shape.width / 2, shape.length / 2, shape.width / 2)
        turned = affinity.rotate(box, shape.angle, origin=(0, 0), use_radians=True)
        found = affinity.translate(turned, shape.x - 1, shape.y - 1)
    else:
        found = affinity.translate(shapely.Polygon(shape.corners), -1, -1)
    assert kind != "disc" or size < 6 or isinstance(shape, Cylinder)
    assert kind != "box" or not isinstance(shape, Cylinder) or size < 10
    inside = shapely.contains_xy(found.buffer(-1e-6), columns, rows)
    assert np.asarray(ndimage.distance_transform_edt(~drawn))[inside].max() <= 1
    left = shapely.points(np.stack([columns, rows], axis=-1)[drawn & ~inside])
    assert np.asarray(shapely.distance(found, left)).max(initial=0.0) <= 1.001


@pytest.mark.parametrize("yaw", [0.0, 0.6])
def test_each_kind_of_thing_stands_in_the_world_where_it_is_drawn(yaw: float) -> None:
    cells = np.full((120, 120), FREE, dtype=np.uint8)
    rows, columns = np.indices(cells.shape) + 0.5
    cells[np.hypot(rows - 30, columns - 30) < 10] = OCCUPIED
    cells[80:100, 20:50] = OCCUPIED
    cells[(columns > 70) & (rows > 30) & (columns + 2 * rows < 170)] = OCCUPIED
    grid = Occupancy(cells, RESOLUTION, (2.0, -1.0, yaw))
    room = room_of_map(grid, "things")
    assert [type(shape) for shape in room.obstacles] == [Cylinder, Polygon, Box]
    plan: FloorPlan = floor_plan(room)
    for column, row in ((30, 30), (35, 90), (75, 40)):
        assert float(plan.clearance(grid.to_world((column, row)), 0.0)) < -0.24
    assert float(plan.clearance(grid.to_world((30, 30)), 0.0)) == pytest.approx(-0.5, abs=0.05)
    assert float(plan.clearance(grid.to_world((30, 60)), 0.0)) == pytest.approx(1.0, abs=0.05)
