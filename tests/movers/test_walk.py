"""Laws of drifting discs, without a simulation."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj import MovingGoal, MovingObstacles
from nomad_mj.errors import ConfigError
from nomad_mj.movers import Drift, Walk
from nomad_mj.movers.walk import Allowed
from nomad_mj.types import FloatArray

STEP = 0.05


def anywhere(_: int, x: float, y: float) -> bool:
    return True


def in_a_corridor(_: int, x: float, y: float) -> bool:
    return abs(y) < 0.2


def nowhere(_: int, x: float, y: float) -> bool:
    return False


directions = st.floats(-10, 10)
spreads = st.floats(0, 1.5)
speeds = st.floats(0.01, 2)


def walk(drift: Drift, discs: int = 3, seed: int = 0) -> Walk:
    return Walk([drift] * discs, np.zeros((discs, 2)), np.random.default_rng(seed))


def track(moving: Walk, steps: int, allowed: Allowed = anywhere) -> FloatArray:
    """Return the places at each step, (steps + 1, n, 2)."""
    places = [moving.array()]
    for _ in range(steps):
        moving.advance(STEP, allowed)
        places.append(moving.array())
    return np.array(places)


@settings(max_examples=40)
@given(directions, spreads, speeds, st.integers(0, 2**32))
def test_free_discs_keep_to_their_speed_and_general_direction(
    direction: float, spread: float, speed: float, seed: int
) -> None:
    steps = np.diff(track(walk(Drift(direction, speed, spread), seed=seed), 200), axis=0)
    lengths = np.hypot(*np.moveaxis(steps, -1, 0))
    assert lengths.max() <= speed * STEP * (1 + 1e-9)
    ahead = steps @ [math.cos(direction), math.sin(direction)]
    assert (ahead >= lengths * math.cos(spread) - 1e-9).all()


def test_speed_and_heading_are_uniform_over_what_they_may_be() -> None:
    drift = Drift(0.3, 0.4, 0.8, period=STEP)
    steps = np.diff(track(walk(drift, 50), 100), axis=0).reshape(-1, 2)
    speed = np.hypot(*steps.T) / STEP
    sideways = np.arctan2(steps[:, 1], steps[:, 0]) - 0.3
    wanted = np.linspace(0.05, 0.95, 10)
    np.testing.assert_allclose(np.quantile(speed, wanted), 0.4 * wanted, atol=0.02)
    np.testing.assert_allclose(np.quantile(sideways, wanted), 1.6 * wanted - 0.8, atol=0.08)


def test_speed_and_heading_last_a_period_and_discs_do_not_turn_together() -> None:
    steps = np.diff(track(walk(Drift(0.0, 1.0, 1.0, period=1.0)), 200), axis=0)
    turns = (np.abs(np.diff(steps, axis=0)) > 1e-9).any(axis=-1)  # (steps, discs)
    for disc in turns.T[:, 20:]:
        assert set(np.diff(np.flatnonzero(disc))) <= {20, 21}
    assert not turns.all(axis=-1).any()


@settings(max_examples=40)
@given(directions, spreads, speeds, st.integers(0, 2**32))
def test_a_disc_is_never_where_it_may_not_be_and_patrols(
    direction: float, spread: float, speed: float, seed: int
) -> None:
    def inside(_: int, x: float, y: float) -> bool:
        return max(abs(x), abs(y)) <= 0.5

    places = track(walk(Drift(direction, speed, spread), seed=seed), 600, inside)
    assert np.abs(places).max() <= 0.5
    if speed > 0.2:  # it comes back again and again
        along = places @ [math.cos(direction), math.sin(direction)]
        assert (np.ptp(along, axis=0) > 0.4).all()


def test_a_disc_that_meets_a_wall_at_its_side_goes_on_along_it() -> None:
    places = track(walk(Drift(0.0, 1.0, 1.0), 1), 400, in_a_corridor)[:, 0]
    assert (np.diff(places[:, 0]) > 0).all() and places[-1, 0] > 2


def test_a_disc_between_walls_waits() -> None:
    places = track(walk(Drift(0.0, 1.0, 1.0)), 30, nowhere)
    np.testing.assert_array_equal(places, 0)


def test_the_same_seed_gives_the_same_bits() -> None:
    first, again = (track(walk(Drift(0.0, 1.0), seed=3), 100) for _ in range(2))
    np.testing.assert_array_equal(first, again)
    assert (first[-1] != track(walk(Drift(0.0, 1.0), seed=4), 100)[-1]).all()


def test_the_defaults_are_those_of_the_papers_figures() -> None:
    goal, obstacles = MovingGoal(), MovingObstacles()
    assert goal.direction == math.pi and obstacles.direction == -math.pi / 2
    assert goal.speed is obstacles.speed is None and obstacles.count == 4


REFUSED: list[tuple[type[Drift], dict[str, Any], str]] = [
    (MovingGoal, {"direction": math.nan}, "direction nan rad: must be finite"),
    (MovingGoal, {"direction": True}, "direction True rad: must be finite"),
    (MovingGoal, {"speed": 0}, "largest speed 0 m/s: must be above 0"),
    (MovingGoal, {"speed": "fast"}, "largest speed 'fast' m/s: must be above 0"),
    (MovingGoal, {"spread": -0.1}, "spread -0.1 rad: must be 0 to pi"),
    (MovingGoal, {"spread": 3.2}, "spread 3.2 rad: must be 0 to pi"),
    (MovingGoal, {"spread": math.nan}, "spread nan rad: must be 0 to pi"),
    (MovingGoal, {"spread": "x"}, "spread 'x' rad: must be 0 to pi"),
    (MovingGoal, {"period": 0}, "period 0 s: must be above 0"),
    (MovingObstacles, {"count": -1}, "count of moving obstacles -1: must be 0, 1, 2, ..."),
    (MovingObstacles, {"count": 1.5}, "count of moving obstacles 1.5: must be 0, 1, 2, ..."),
    (MovingObstacles, {"count": True}, "count of moving obstacles True: must be 0, 1, 2, ..."),
    (MovingObstacles, {"radius": 0}, "radius of moving obstacles 0 m: must be above 0"),
    (MovingObstacles, {"height": math.inf}, "height of moving obstacles inf m: must be above 0"),
    (MovingObstacles, {"period": -1}, "period -1 s: must be above 0"),
]


@pytest.mark.parametrize(("cls", "options", "message"), REFUSED)
def test_a_motion_that_makes_no_sense_is_refused(
    cls: type[Drift], options: dict[str, Any], message: str
) -> None:
    with pytest.raises(ConfigError) as caught:
        cls(**options)
    assert str(caught.value) == message
