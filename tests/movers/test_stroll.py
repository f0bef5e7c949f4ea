"""Laws of people who walk about: on their way, at their speed, and never into anything."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj import MotorEnvironment, NomadError, RangeNoise, Walkers, load
from nomad_mj.errors import ConfigError
from nomad_mj.movers import Movers, Stroll, Walker
from nomad_mj.movers.movers import GAP, ROBOT_GAP, START_GAP
from nomad_mj.movers.stroll import PATIENCE
from nomad_mj.types import FloatArray

OwnRoom = Callable[..., Path]
STEP, RADIUS = 0.05, 0.265
coordinates = st.floats(-5, 5).map(lambda value: round(value, 2))
ways = st.lists(st.tuples(coordinates, coordinates), min_size=2, max_size=5, unique=True)
speeds = st.floats(0.1, 2)


def anywhere(_: int, x: float, y: float) -> bool:
    return True


def west_of_1(_: int, x: float, y: float) -> bool:
    return x < 1.0


def choose(_: int, place: tuple[float, float], rng: np.random.Generator) -> tuple[float, float]:
    x, y = rng.uniform(-5, 5, 2).tolist()
    return x, y


def track(
    walker: Walker, steps: int, allowed: Any = anywhere, seed: int = 0, at: Any = (0.0, 0.0)
) -> FloatArray:
    """Return the places at each step, (steps + 1, 2)."""
    places = [walker.way[0] if walker.way else at]
    stroll = Stroll([walker], places, choose, np.random.default_rng(seed))
    seen = [places[0]]
    for _ in range(steps):
        stroll.advance(STEP, allowed)
        seen.append(places[0])
    return np.array(seen)


def off_the_way(places: FloatArray, way: tuple[tuple[float, float], ...]) -> float:
    """Return how far the farthest place is from the legs between way points."""
    gaps: list[FloatArray] = []
    for start, end in zip(way, [*way[1:], way[0]], strict=True):
        along = np.subtract(end, start)
        share = np.clip((places - start) @ along / (along @ along), 0, 1)
        gaps.append(np.hypot(*(places - start - share[:, None] * along).T))
    return float(np.min(gaps, axis=0).max())


@settings(max_examples=40, deadline=None)
@given(ways, speeds, st.floats(0, 2), st.integers(0, 2**32))
def test_a_walker_stays_on_its_way_and_comes_to_every_point_of_it(
    way: list[tuple[float, float]], speed: float, pause: float, seed: int
) -> None:
    around = sum(math.dist(a, b) for a, b in zip(way, [*way[1:], way[0]], strict=True))
    steps = int((around / speed + len(way) * (pause + 3 * STEP)) / STEP) + 5
    places = track(Walker(speed, pause, tuple(way)), steps, seed=seed)
    assert np.hypot(*np.diff(places, axis=0).T).max() <= speed * STEP * (1 + 1e-9)
    assert off_the_way(places, tuple(way)) < 1e-9
    for point in way:
        assert (np.hypot(*(places - point).T) == 0).any()


@settings(max_examples=40, deadline=None)
@given(speeds, st.floats(0, 2), st.integers(0, 2**32))
def test_a_walker_without_a_way_comes_about_and_never_where_it_may_not_be(
    speed: float, pause: float, seed: int
) -> None:
    def inside(_: int, x: float, y: float) -> bool:
        return max(abs(x), abs(y)) <= 4

    places = track(Walker(speed, pause), 1500, inside, seed)
    assert np.abs(places).max() <= 4
    assert np.hypot(*np.diff(places, axis=0).T).max() <= speed * STEP * (1 + 1e-9)
    assert np.ptp(places, axis=0).max() > min(2, 10 * speed)


@settings(max_examples=30, deadline=None)
@given(speeds, st.integers(0, 2**32))
def test_before_a_barrier_a_walker_waits_and_turns_round(speed: float, seed: int) -> None:
    places = track(Walker(speed, 0.0, ((0.0, 0.0), (2.0, 0.0))), 900, west_of_1, seed)[:, 0]
    assert places.max() < 1
    waits = np.diff(places) == 0
    first = int(np.argmax(waits))
    length = int(np.argmin(waits[first:])) * STEP
    assert PATIENCE[0] - STEP <= length <= PATIENCE[1] + 3 * STEP
    assert (places[first:] == 0).any()


def test_pauses_are_no_longer_than_said_and_differ() -> None:
    places = track(Walker(1.0, 2.0, ((0.0, 0.0), (1.0, 0.0))), 4000)
    rests = np.diff(np.flatnonzero(np.diff(np.r_[1, np.hypot(*np.diff(places, axis=0).T), 1] > 0)))
    lengths = rests[::2] * STEP
    assert 1.5 < lengths.max() <= 2.0 + 2 * STEP and lengths.min() < 0.5


def test_the_same_seed_gives_the_same_walk() -> None:
    first, again, other = (track(Walker(1.0, 1.0), 300, seed=seed) for seed in (3, 3, 4))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()


def motor(room: Any, **options: Any) -> MotorEnvironment:
    return load("motor", room=room, task_kwargs={"random": 0, "ends_at_goal": False} | options)


def movers_of(env: MotorEnvironment) -> Movers:
    assert env.task.movers is not None
    return env.task.movers


WALKERS = {"moving_obstacles": Walkers(count=4, speed=1.2, pause=0.5)}
CASES: list[tuple[str, dict[str, Any]]] = [("hall", {}), ("clutter", WALKERS), ("hall", WALKERS)]


@pytest.mark.parametrize(("room", "options"), CASES)
def test_walkers_keep_the_rules_of_all_that_moves(room: str, options: dict[str, Any]) -> None:
    env = motor(room, range_noise=RangeNoise("none"), **options)
    plan, movers = env.task.scene.plan, movers_of(env)
    count = len(movers.radii)
    apart = movers.radii[:, None] + movers.radii + GAP - np.diag([np.inf] * count) - 1e-9
    moved = np.zeros(count)
    for seed in range(2):
        env.reset(seed=seed)
        robot = np.array(env.physics.pose()[:2])
        assert (np.hypot(*(movers.obstacles - robot).T) >= 0.25 + RADIUS + START_GAP).all()
        for _ in range(500):
            before = movers.obstacles
            env.step(np.zeros(3))
            places = movers.obstacles
            moved += np.hypot(*(places - before).T)
            assert (plan.clearance(places, 0.25) > 0.6 * GAP).all()
            assert (np.linalg.norm(places[:, None] - places, axis=-1) >= apart).all()
            gaps = np.hypot(*(places - robot).T) - 0.25 - RADIUS
            assert (gaps >= ROBOT_GAP - 1e-6).all() and not env.physics.bumpers().any()
    assert (moved > 5).all()
    env.close()


def test_people_are_seen_and_bumped_into() -> None:
    still = Walkers(count=1, speed=1e-9, height=1.7)
    env = motor("empty_room", moving_obstacles=still, range_noise=RangeNoise("none"))
    env.reset(seed=0, start=(5.0, 5.0))
    place = movers_of(env).obstacles[0]
    heading = math.atan2(place[1] - 5, place[0] - 5)
    step = env.reset(seed=0, start=(5.0, 5.0, heading))
    gap = math.dist(place, (5, 5)) - 0.25 - RADIUS
    assert float(step.observation["sonar"].min()) == pytest.approx(min(gap, 6.5), abs=0.05)
    for _ in range(int(gap / 0.3 / STEP) + 60):
        step = env.step((0.3, 0.0, 0.0))
    assert step.observation["bumpers"].any()
    np.testing.assert_allclose(movers_of(env).obstacles[0], place, atol=1e-6)
    env.close()


def test_the_hall_has_three_walkers() -> None:
    env = motor("hall")
    anna, ben, cleo = (body.walker for body in env.task.scene.moving.obstacles)
    assert anna and ben and cleo
    assert anna.way == ((1.2, 5.0), (8.8, 5.0)) and len(ben.way) == 4 and cleo.way == ()
    assert (anna.speed, anna.pause) == (0.6, 2.0)
    env.close()


def test_options_add_walkers_to_the_files() -> None:
    env = motor("hall", moving_obstacles=Walkers(count=2, speed=None))
    found = [body.walker for body in env.task.scene.moving.obstacles]
    speeds_found = [walker.speed for walker in found if walker]
    assert speeds_found == pytest.approx([0.6, 0.5, 0.7, 0.305, 0.305])
    env.close()


PERSON = '<geom type="cylinder" size="0.25 0.6"/>'


def person(user: str, place: str = "-3 0 0.6", sites: str = "") -> str:
    return f'<body name="moving_a" mocap="true" pos="{place}" {user}>{PERSON}</body>{sites}'


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (person('user="-1 2"'), "has user data -1 2: a walker's must be its speed"),
        (person('user="0 2"'), "has user data 0 2: a walker's"),
        (person('user="0.5 -2"'), "has user data 0.5 -2: a walker's"),
        (
            person('user="0.5 2"', sites='<site name="moving_a_way_1" pos="40 0 0"/>'),
            "cannot walk straight from (-3, 0) to (40, 0); put another way point in between",
        ),
        (person('user="0.5 2"', place="4.9 0 0.6"), "at (4.9, 0) is outside the room"),
    ],
)
def test_walkers_that_make_no_sense_are_refused_in_one_line(
    own_room: OwnRoom, body: str, told: str
) -> None:
    with pytest.raises(NomadError) as caught:
        motor(own_room(body))
    assert told in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("pause", [-1, math.nan, "long", True])
def test_a_pause_that_makes_no_sense_is_refused(pause: Any) -> None:
    with pytest.raises(ConfigError, match=r"pause of walkers .*: must be 0 or more"):
        Walkers(pause=pause)
