"""What sonars suffer: turns, crosstalk, limits and dropouts; laws, and work in a room."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj import Crosstalk, FiringOrder, RangeNoise, SonarEffects, load
from nomad_mj.errors import ConfigError
from nomad_mj.tasks.crosstalk import Echoes, within_reach
from nomad_mj.tasks.firing import Order, Stale, turns
from nomad_mj.types import FloatArray, RangeRing

CONES = 16
RADIUS = 0.265
QUIET = RangeNoise("none")
orders = st.sampled_from(["sequential", "spread"])


def ring(cones: int) -> RangeRing:
    return RangeRing("sonar", tuple(np.arange(cones) * 2 * np.pi / cones), 0.2, 0.1, 6.0)


def drive(steps: int = 40, seed: int = 5, episodes: int = 1, **options: Any) -> FloatArray:
    """Return all observations, (steps + 1, ...), of the last of some episodes in the same room."""
    made = load("motor", "paper_room", task_kwargs={"random": seed, **options})
    seen = []
    for _ in range(episodes):
        rng = np.random.default_rng(2)
        seen = [made.reset(seed=seed, start=0)]
        seen += [made.step(rng.uniform(-1, 1, 3) * [0.5, 1, 1.5]) for _ in range(steps)]
    made.close()
    return np.array([np.concatenate([*step.observation.values()]) for step in seen])


@given(st.integers(1, 24), st.integers(1, 30), orders)
def test_in_one_round_every_cone_fires_once_and_never_more_than_may(
    cones: int, per_step: int, order: Order
) -> None:
    turn, period = turns(FiringOrder(per_step, order), ring(cones))
    assert period == math.ceil(cones / per_step)
    together = np.bincount(turn, minlength=period)
    assert together.sum() == cones and len(together) == period and together.max() <= per_step


@given(st.sampled_from([4, 8, 12, 16, 24]), st.sampled_from([2, 4]))
def test_spread_cones_are_as_far_apart_as_can_be_and_others_are_neighbours(
    cones: int, per_step: int
) -> None:
    gaps: dict[Order, int] = {"spread": cones // per_step, "sequential": 1}
    for order, apart in gaps.items():
        turn, _ = turns(FiringOrder(per_step, order), ring(cones))
        for now in np.unique(turn):
            fires = np.flatnonzero(turn == now)
            assert np.diff(fires, append=fires[0] + cones).min() == apart


@given(st.integers(1, 12), st.integers(1, 5), orders, st.integers(0, 2**32), st.integers(1, 30))
def test_each_reading_is_new_or_the_last_one_and_none_is_older_than_a_round(
    cones: int, per_step: int, order: Order, seed: int, steps: int
) -> None:
    turn, period = turns(FiringOrder(per_step, order), ring(cones))
    stale = Stale(turn, np.full(cones, period))
    true = np.random.default_rng(seed).random((steps, cones))
    told = np.array([stale.hold(row) for row in true])
    np.testing.assert_array_equal(told[0], true[0])
    for step in range(1, steps):
        new = told[step] == true[step]
        np.testing.assert_array_equal(told[step][~new], told[step - 1][~new])
        np.testing.assert_array_equal(new, turn == (step - 1) % period)
    for step in range(steps):  # in the last round, or in the first reading of all
        assert all(
            told[step, c] in true[max(step - period + 1, 0) : step + 1, c] for c in range(cones)
        )
    stale.start()
    np.testing.assert_array_equal(stale.hold(true[-1]), true[-1])


ranges = st.lists(st.floats(0.0, 6.0), min_size=8, max_size=8).map(np.array)
offsets = st.floats(-0.02, 0.1)
EARS = np.arange(8)


@given(ranges, offsets, st.floats(0.1, 0.5))
def test_an_echo_of_a_cones_own_pulse_tells_how_far_it_is(
    away: FloatArray, offset: float, radius: float
) -> None:
    echoes = Echoes(np.array(ring(8).bearings), np.full(8, offset), radius)
    readings = echoes.readings(np.maximum(away, -offset), EARS)
    np.testing.assert_allclose(np.diag(readings), np.maximum(away, -offset), atol=1e-9)


@given(ranges, offsets, st.floats(0.1, 0.5))
def test_the_way_to_another_cone_is_at_most_longer_by_what_lies_between_the_two(
    away: FloatArray, offset: float, radius: float
) -> None:
    echoes = Echoes(np.array(ring(8).bearings), np.full(8, offset), radius)
    readings = echoes.readings(away, EARS)
    assert np.abs(readings - away).max() <= radius - offset + 0.1 + 1e-9  # half of twice the radius
    np.testing.assert_array_equal(echoes.readings(away, EARS[3:5]), readings[3:5])


def test_a_pulse_past_a_box_on_one_side_shortens_the_reading_of_the_next_cone() -> None:
    """A right angle: the sites lie on the axes, the obstacle one metre before the first."""
    echoes = Echoes(np.array([0.0, np.pi / 2]), np.zeros(2), 0.3)
    heard = echoes.readings(np.array([0.4, 5.0]), np.array([1]))
    assert heard[0, 0] == pytest.approx((0.4 + math.hypot(0.7, 0.3)) / 2)


def test_cones_hear_their_neighbours_round_the_ring_but_not_themselves() -> None:
    near = within_reach(np.array(ring(CONES).bearings), math.pi / 4)
    assert (near.sum(axis=1) == 4).all() and (near == near.T).all()
    assert near[0].nonzero()[0].tolist() == [1, 2, 14, 15]


def sonars(
    room: Path | str, start: tuple[float, float], rounds: int = 1, **effects: Any
) -> FloatArray:
    """Return (rounds, CONES) first readings of a robot without noise."""
    options = {"range_noise": QUIET, "sonar": SonarEffects(**effects)}
    made = load("motor", room, task_kwargs=options)
    seen = [made.reset(seed=each, start=start).observation["sonar"] for each in range(rounds)]
    made.close()
    return np.array(seen)


def test_crosstalk_only_makes_readings_shorter_and_only_of_those_that_fire_together() -> None:
    plain = sonars("paper_room", (2.0, 5.0))[0]
    heard = sonars("paper_room", (2.0, 5.0), crosstalk=Crosstalk(1.0))[0]
    assert (heard <= plain).all() and (heard < plain - 0.3).sum() >= 3
    apart: dict[str, Any] = {"firing": FiringOrder(4, "spread"), "crosstalk": Crosstalk(1.0)}
    np.testing.assert_array_equal(sonars("paper_room", (2.0, 5.0), **apart)[0], plain)
    together: dict[str, Any] = {"firing": FiringOrder(4, "sequential"), "crosstalk": Crosstalk(1.0)}
    some = sonars("paper_room", (2.0, 5.0), **together)[0]
    assert (heard <= some).all() and (some < plain - 0.3).any()


def test_crosstalk_comes_as_often_as_asked_for() -> None:
    plain, always = (
        sonars("paper_room", (2.0, 5.0), crosstalk=Crosstalk(chance))[0] for chance in (0.0, 1.0)
    )
    can = always < plain
    often = sonars("paper_room", (2.0, 5.0), 400, crosstalk=Crosstalk(0.2))
    assert ((often == plain) | (often == always)).all()
    rate = (often[:, can] == always[can]).mean()
    assert rate == pytest.approx(0.2, abs=4 * math.sqrt(0.16 / 400 / can.sum()))


def test_nothing_is_heard_beyond_the_limit_of_a_cone() -> None:
    plain = sonars("empty_room", (5.0, 5.0))[0]
    limits = (4.0, None) * 8
    seen = sonars("empty_room", (5.0, 5.0), limits=limits)[0]
    far = plain > 4.0
    assert far[::2].any()
    np.testing.assert_array_equal(seen[::2], np.where(far, 6.5, plain)[::2])
    np.testing.assert_array_equal(seen[1::2], plain[1::2])


@settings(max_examples=5)
@given(st.floats(0.05, 0.95), st.integers(0, 2**31))
def test_echoes_are_lost_as_often_as_asked_for(dropout: float, seed: int) -> None:
    seen = drive(60, seed, range_noise=QUIET, sonar=SonarEffects(dropout=dropout))
    plain = drive(60, seed, range_noise=QUIET)
    sonar, true = seen[:, :CONES], plain[:, :CONES]
    assert ((sonar == true) | (sonar == 6.5)).all()
    near = true < 6.5
    lost = (sonar == 6.5)[near].mean()
    assert lost == pytest.approx(dropout, abs=5 * math.sqrt(dropout * (1 - dropout) / near.sum()))
    np.testing.assert_array_equal(seen[:, CONES:], plain[:, CONES:])


EVERYTHING = SonarEffects(
    firing=FiringOrder(2), crosstalk=Crosstalk(0.3), limits=(5.0,) * CONES, dropout=0.05
)


def test_without_effects_nothing_changes_to_the_bit_and_with_them_only_the_sonar() -> None:
    plain = drive()
    none = SonarEffects(crosstalk=Crosstalk(0.0), firing=FiringOrder(CONES), limits=(None,) * CONES)
    np.testing.assert_array_equal(drive(sonar=none), plain)
    seen = drive(sonar=EVERYTHING)
    np.testing.assert_array_equal(seen[:, CONES:], plain[:, CONES:])
    assert (seen[1:, :CONES] == seen[:-1, :CONES]).mean() > 0.8  # stale, the most of them


def test_the_same_seed_gives_the_same_bits_whatever_was_before() -> None:
    first = drive(sonar=EVERYTHING)
    np.testing.assert_array_equal(drive(sonar=EVERYTHING, episodes=3), first)
    assert (drive(sonar=EVERYTHING, seed=6)[:, :CONES] != first[:, :CONES]).mean() > 0.5


def test_an_effect_by_chance_does_not_change_another_one() -> None:
    lossy = drive(range_noise=QUIET, sonar=SonarEffects(dropout=0.1))[:, :CONES] == 6.5
    both = SonarEffects(dropout=0.1, crosstalk=Crosstalk(0.5))
    assert (drive(range_noise=QUIET, sonar=both)[:, :CONES][lossy] == 6.5).all()


def test_rings_of_any_name_can_suffer(ring_robot: Callable[..., Path]) -> None:
    effects = SonarEffects(("infrared",), firing=FiringOrder(1), dropout=1.0)
    options = {"sonar": effects}
    with load("motor", "empty_room", ring_robot(), task_kwargs=options) as made:
        assert (made.reset().observation["infrared"] == 1.5).all()
    with pytest.raises(
        ConfigError, match=r"^sonar ring 'sonar': the robot has no such ring; .* infrared$"
    ):
        load("motor", "empty_room", ring_robot(), task_kwargs={"sonar": SonarEffects(dropout=0.1)})
    with pytest.raises(
        ConfigError, match=r"^sonar limits: there are 2, but 8 cones in the ring 'infrared'$"
    ):
        few = SonarEffects(("infrared",), limits=(1.0, 2.0))
        load("motor", "empty_room", ring_robot(), task_kwargs={"sonar": few})


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: FiringOrder(0), "firing order per_step 0: must be 1, 2, 3, ..."),
        (lambda: FiringOrder(1, "loud"), "firing order 'loud': must be sequential or spread"),  # type: ignore[arg-type]
        (lambda: Crosstalk(1.1), "crosstalk probability 1.1: must be in [0, 1]"),
        (lambda: Crosstalk(math.nan), "crosstalk probability nan: must be in [0, 1]"),
        (lambda: Crosstalk(0.1, 0.0), "crosstalk reach 0.0: must be in (0, pi] rad"),
        (lambda: SonarEffects(dropout=-0.1), "sonar dropout -0.1: must be in [0, 1]"),
        (lambda: SonarEffects(limits=(0.0,)), "sonar limits: 0.0 must be above 0 m, or None"),
        (lambda: SonarEffects(()), "sonar effects: need a ring in rings"),
    ],
)
def test_what_makes_no_sense_is_refused(make: Callable[[], object], told: str) -> None:
    with pytest.raises(ConfigError) as caught:
        make()
    assert str(caught.value) == told


def test_the_last_bit_of_a_bearing_does_not_make_the_first_cone_the_last() -> None:
    bearings = np.arange(16) * np.pi / 8
    for tiny in (0.0, 1e-17, -1e-17, -1e-12):
        ring = RangeRing("sonar", (tiny, *bearings[1:].tolist()), 0.26, 0.0, 6.5)
        assert turns(FiringOrder(4), ring)[0].tolist() == [k // 4 for k in range(16)]
