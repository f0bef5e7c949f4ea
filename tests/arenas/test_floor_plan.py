from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from nomad_mj.arenas import FloorPlan
from nomad_mj.errors import StartError
from nomad_mj.scene import build_scene

RADIUS = 0.25


def walls(x0: float, y0: float, x1: float, y1: float) -> list[tuple[str, shapely.Polygon]]:
    return [
        ("wall_west", shapely.box(x0 - 0.1, y0 - 0.1, x0, y1 + 0.1)),
        ("wall_east", shapely.box(x1, y0 - 0.1, x1 + 0.1, y1 + 0.1)),
        ("wall_south", shapely.box(x0, y0 - 0.1, x1, y0)),
        ("wall_north", shapely.box(x0, y1, x1, y1 + 0.1)),
    ]


BOX = ("obstacle_box", shapely.box(2, 1, 4, 3))
CLOSED = FloorPlan([*walls(0, 0, 6, 4), BOX])
OPEN = FloorPlan([BOX])
EMPTY = FloorPlan([])
SPLIT = FloorPlan([*walls(0, 0, 6, 4), ("wall_middle", shapely.box(2.9, -0.1, 3.1, 4.1))])
coordinates = st.tuples(st.floats(0.0, 6.0), st.floats(0.0, 4.0))


def test_clearance_by_hand() -> None:
    places = [[1, 2], [0.1, 2], [5, 3.5], [3, 2.9], [3, 2]]
    expected = [0.75, -0.15, 0.25, -0.35, -1.25]
    np.testing.assert_allclose(CLOSED.clearance(places, RADIUS), expected, atol=1e-12)


@given(st.lists(coordinates, min_size=6, max_size=6))
def test_clearance_of_many_is_that_of_each(places: list[tuple[float, float]]) -> None:
    stacked = CLOSED.clearance(np.reshape(places, (2, 3, 2)), RADIUS)
    assert stacked.shape == (2, 3)
    each = [float(CLOSED.clearance(place, RADIUS)) for place in places]
    np.testing.assert_array_equal(stacked.ravel(), each)


@given(coordinates, coordinates, st.floats(0, 1))
def test_clearance_changes_no_faster_than_the_robot_moves(
    a: tuple[float, float], b: tuple[float, float], radius: float
) -> None:
    near, far = CLOSED.clearance([a, b], radius)
    assert abs(near - far) <= np.hypot(a[0] - b[0], a[1] - b[1]) + 1e-9
    assert near + radius == pytest.approx(float(CLOSED.clearance(a, 0.0)))


@given(coordinates)
def test_free_space_is_where_the_clearance_is_positive(place: tuple[float, float]) -> None:
    clearance = float(CLOSED.clearance(place, RADIUS))
    if abs(clearance) > 0.002:
        assert bool(CLOSED.reaches(place, [1, 1], RADIUS)) == (clearance > 0)


def test_reaches_only_its_own_side_of_a_wall() -> None:
    places = [[[1, 1], [5, 1]], [[2.8, 2], [12, 12]]]
    np.testing.assert_array_equal(SPLIT.reaches(places, [1, 3], RADIUS), [[1, 0], [0, 0]])


def test_no_room_at_the_seed_is_an_error_that_names_the_obstacle() -> None:
    with pytest.raises(StartError, match=r"radius 0.25 m does not fit at \(3.00, 1.10\).*box'"):
        CLOSED.free_space(RADIUS, [3, 1.1])


def test_bounds() -> None:
    np.testing.assert_allclose(CLOSED.bounds, [-0.1, -0.1, 6.1, 4.1])
    assert CLOSED.describe_bounds() == "0 to 6 m in x and 0 to 4 m in y"
    assert OPEN.describe_bounds() == "2 to 4 m in x and 1 to 3 m in y"
    assert np.isnan(EMPTY.bounds).all()
    assert EMPTY.describe_bounds() == "without bounds"


def test_a_room_without_walls_is_cut_off_around_what_stands_in_it() -> None:
    x0, y0, x1, y1 = OPEN.free_space(RADIUS, [0, 0]).bounds
    assert (x0, y0, x1, y1) == (-10, -10, 14, 13)
    assert OPEN.free_space(RADIUS, [30, 0]).bounds[2] == 40
    places = OPEN.sample_free(200, np.random.default_rng(0), RADIUS, 0.1, [0, 0], 0.5)
    assert (places >= [-1, -1]).all()
    assert (places <= [5, 4]).all()


def test_a_room_with_nothing_in_it() -> None:
    assert EMPTY.clearance([1, 2], RADIUS) == np.inf
    assert EMPTY.clearance(np.zeros((3, 4, 2)), RADIUS).shape == (3, 4)
    assert EMPTY.sample_free(10, np.random.default_rng(0), RADIUS, 0.1, [3, 3], 0.5).shape == (
        10,
        2,
    )


def test_samples_keep_every_condition() -> None:
    goal = np.array([1.0, 1.0])
    places = SPLIT.sample_free(500, np.random.default_rng(1), RADIUS, 0.2, goal, 1.0)
    assert places.shape == (500, 2)
    assert (SPLIT.clearance(places, RADIUS) > 0.2).all()
    assert (np.linalg.norm(places - goal, axis=1) >= 1.0).all()
    assert (places[:, 0] < 3).all()


def test_samples_are_uniform() -> None:
    places = CLOSED.sample_free(4000, np.random.default_rng(2), RADIUS, 0.0, [1, 1], 0.0)
    west = shapely.box(0.25, 0.25, 1.75, 3.75).area / CLOSED.free_space(RADIUS, [1, 1]).area
    assert np.mean(places[:, 0] < 1.75) == pytest.approx(west, abs=0.03)


def test_samples_depend_on_the_generator_alone_and_not_on_their_number() -> None:
    def draw(n: int, seed: int) -> list[list[float]]:
        rng = np.random.default_rng(seed)
        return CLOSED.sample_free(n, rng, RADIUS, 0.1, [1, 1], 1.0).tolist()

    assert draw(300, 5) == draw(300, 5)
    assert draw(7, 5) == draw(300, 5)[:7]
    assert draw(7, 5) != draw(7, 6)
    assert draw(0, 5) == []


def test_asking_for_places_that_are_not_there() -> None:
    with pytest.raises(StartError, match=r"found 0 of 3 places .* ask for less") as error:
        CLOSED.sample_free(3, np.random.default_rng(0), RADIUS, 0.1, [1, 1], 20.0)
    assert "\n" not in str(error.value)


def test_a_picture_shows_goal_and_starts_wherever_things_stand(tmp_path: Path) -> None:
    room = tmp_path / "open.xml"
    room.write_text(
        "<mujoco><worldbody><geom name='pillar' type='cylinder' size='0.3 0.45' pos='0 0 0.45'/>"
        "<site name='goal' pos='4 0 0'/><site name='start_0' pos='-3 0.1 0'/></worldbody></mujoco>"
    )
    x0, y0, x1, y1 = build_scene(room, "nomad200").shown_bounds
    assert (x0, x1) == (-4.0, 5.0) and (y0, y1) == pytest.approx((-0.3, 0.3), abs=0.01)
