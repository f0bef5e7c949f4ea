import time

import mujoco
import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy import sparse
from scipy.sparse import csgraph

from nomad_mj.arenas import Arena, FloorPlan, Geodesic
from nomad_mj.assets import list_rooms
from nomad_mj.errors import StartError
from nomad_mj.types import FloatArray

RADIUS = 0.265


def load(room: str) -> tuple[FloorPlan, FloatArray]:
    model = mujoco.MjModel.from_xml_path(str(list_rooms()[room]))
    return FloorPlan.from_model(model, 0.9), Arena.from_model(model, room).goal


CLUTTER, GOAL = load("clutter")
TO_GOAL = Geodesic(CLUTTER, GOAL, RADIUS)
PLACES = CLUTTER.sample_free(300, np.random.default_rng(7), RADIUS, 0.0, GOAL, 0.0)
places = st.sampled_from(PLACES.tolist())
few = settings(max_examples=15, deadline=None)


def in_sight(a: list[float], b: list[float], radius: float) -> bool:
    gaps = [shapely.distance(shape, shapely.LineString([a, b])) for shape in CLUTTER.footprints]
    return float(min(gaps)) >= radius


@given(places)
def test_not_shorter_than_the_straight_line_and_equal_where_it_is_free(place: list[float]) -> None:
    straight = float(np.linalg.norm(np.array(place) - GOAL))
    length = float(TO_GOAL.length(place))
    assert length >= straight - 1e-9
    if in_sight(place, GOAL.tolist(), RADIUS):
        assert length == pytest.approx(straight, abs=1e-9)
    elif not in_sight(place, GOAL.tolist(), RADIUS - 0.01):
        assert length > straight


@given(places, places)
@few
def test_the_way_back_is_as_long(a: list[float], b: list[float]) -> None:
    there = Geodesic(CLUTTER, b, RADIUS).length(a)
    back = Geodesic(CLUTTER, a, RADIUS).length(b)
    assert there == pytest.approx(back, abs=1e-4)


@given(places, places)
@few
def test_a_detour_is_not_shorter(a: list[float], b: list[float]) -> None:
    detour = float(Geodesic(CLUTTER, b, RADIUS).length(a)) + float(TO_GOAL.length(b))
    assert float(TO_GOAL.length(a)) <= detour + 1e-4


@given(places, st.floats(0.0, RADIUS))
@example(PLACES[0].tolist(), 1e-15)  # where GEOS, left alone, loses whole obstacles
@few
def test_a_thinner_robot_has_no_longer_way(place: list[float], radius: float) -> None:
    assert Geodesic(CLUTTER, GOAL, radius).length(place) <= TO_GOAL.length(place) + 1e-4


@given(places)
def test_a_path_is_as_long_as_said_and_stays_free(place: list[float]) -> None:
    path = TO_GOAL.path(place)
    np.testing.assert_array_equal(path[[0, -1]], [place, GOAL.tolist()])
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert steps.sum() == pytest.approx(float(TO_GOAL.length(place)))
    along = shapely.line_interpolate_point(
        shapely.LineString(path), np.linspace(0, 1, 400), normalized=True
    )
    # The rounded corners are polygons inside the arcs: up to 0.5 % of the radius too near.
    assert CLUTTER.clearance(shapely.get_coordinates(along), RADIUS).min() > -0.005 * RADIUS - 1e-6


def test_sight_lines_may_run_along_walls() -> None:
    shelf = [shapely.box(x, 4.7, x + 0.3, 5.0) for x in (2.1, 4.3, 6.6)]
    boxes = [*shelf, shapely.box(0, -1, 10, 4.7), shapely.box(3.1, 5.0, 3.4, 9)]
    plan = FloorPlan((str(i), box) for i, box in enumerate(boxes))
    for radius in (0.0, 0.1, 0.3):
        length = float(Geodesic(plan, [3.0 - radius, 5.0 + radius], radius).length([0, 5 + radius]))
        assert length == pytest.approx(3.0 - radius, abs=1e-6)


def test_around_a_box_by_hand() -> None:
    plan = FloorPlan([("box", shapely.box(-1, -1, 1, 1))])
    length = float(Geodesic(plan, [3, 0], 0.0).length([-3, 0]))
    assert length == pytest.approx(2 + 2 * np.hypot(2, 1), abs=1e-5)
    radius = 0.5  # two tangents, two arcs and a straight piece
    tangent, lean = np.sqrt(5 - radius**2), np.arctan2(1, 2) + np.arcsin(radius / np.sqrt(5))
    exact = 2 + 2 * tangent + 2 * radius * lean
    length = float(Geodesic(plan, [3, 0], radius).length([-3, 0]))
    assert exact * 0.998 < length <= exact + 1e-6


def grid_lengths(plan: FloorPlan, goal: FloatArray, starts: FloatArray, step: float) -> FloatArray:
    """Shortest paths on a grid of free places joined to 32 neighbours (up to 3 steps away)."""
    side = np.arange(0, 10 + step / 2, step)
    x, y = np.meshgrid(side, side, indexing="ij")
    nodes = np.stack([x, y], axis=-1)
    free = plan.clearance(nodes, RADIUS) > 0
    index = np.arange(free.size).reshape(free.shape)
    ways = [(i, j) for i in range(-3, 4) for j in range(-3, 4) if np.gcd(i, j) == 1 and i >= 0]
    graph = sparse.csr_array((free.size, free.size))
    for i, j in ways:
        here = (slice(0, len(side) - i), slice(max(0, -j), len(side) - max(0, j)))
        there = (slice(i, len(side)), slice(max(0, j), len(side) + min(0, j)))
        both = free[here] & free[there]
        weight = np.full(int(both.sum()), step * np.hypot(i, j))
        pairs = (index[here][both], index[there][both])
        graph = graph + sparse.csr_array((weight, pairs), shape=graph.shape)
    rows, columns = np.rint(np.concatenate([goal[None], starts]) / step).astype(int).T
    ends = index[rows, columns]
    return csgraph.dijkstra(graph, directed=False, indices=ends[0])[ends[1:]]


@pytest.mark.parametrize("room", ["paper_room", "clutter", "corridor"])
def test_agrees_with_a_fine_grid(room: str) -> None:
    plan, goal = load(room)
    starts = plan.sample_free(60, np.random.default_rng(3), RADIUS, 0.1, goal, 2.0)
    exact = Geodesic(plan, goal, RADIUS).length(starts)
    grid = grid_lengths(plan, goal, starts, 0.05)
    assert np.isfinite(grid).all()
    ratio = grid / exact
    assert ratio.min() > 0.98
    assert ratio.max() < 1.06
    assert 1.0 < np.median(ratio) < 1.03


def test_many_points_at_once_are_each_alone() -> None:
    lengths = TO_GOAL.length(PLACES[:12].reshape(3, 4, 2))
    assert lengths.shape == (3, 4)
    each = [float(TO_GOAL.length(place)) for place in PLACES[:12]]
    np.testing.assert_allclose(lengths.ravel(), each, rtol=1e-12)
    assert TO_GOAL.length(np.zeros((0, 2))).shape == (0,)


def test_no_way_is_infinitely_long() -> None:
    plan, goal = load("paper_room")
    to_goal = Geodesic(plan, goal, RADIUS)
    np.testing.assert_array_equal(to_goal.length([[4.8, 5.0], [15, 15], [0.1, 5]]), np.inf)
    with pytest.raises(StartError, match=r"no path .* from \(15.00, 15.00\) to the goal at \(7.40"):
        to_goal.path([15, 15])
    with pytest.raises(StartError, match="does not fit at"):
        Geodesic(plan, [4.8, 5.0], RADIUS)


def test_at_the_goal() -> None:
    assert TO_GOAL.length(GOAL) == 0
    np.testing.assert_array_equal(TO_GOAL.path(GOAL), [GOAL, GOAL])


def test_with_nothing_in_the_way() -> None:
    assert Geodesic(FloorPlan([]), [0, 0], RADIUS).length([3, 4]) == pytest.approx(5)


def test_fast_enough_to_be_made_at_every_evaluation() -> None:
    begin = time.perf_counter()
    Geodesic(CLUTTER, GOAL, RADIUS).length(PLACES)
    assert time.perf_counter() - begin < 1.5


def test_a_large_room_is_measured_in_seconds_and_in_little_memory() -> None:
    rng = np.random.default_rng(0)
    posts = [shapely.Point(*rng.uniform(0, 40, 2)).buffer(0.3, quad_segs=16) for _ in range(120)]
    plan = FloorPlan((str(number), post) for number, post in enumerate(posts))
    goal = plan.sample_free(1, rng, RADIUS, 0.1, [-1.0, -1.0], 0.0)[0]
    begin = time.thread_time()
    to_goal = Geodesic(plan, goal, RADIUS)
    places = plan.sample_free(200, rng, RADIUS, 0.1, goal, 1.0)
    ratio = to_goal.length(places) / np.linalg.norm(places - goal, axis=-1)
    assert time.thread_time() - begin < 6
    assert ratio.min() >= 1 - 1e-9 and ratio.max() < 1.3
