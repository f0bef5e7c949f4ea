"""The drift of the heading, and the gyroscope that corrects it."""

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nomad_mj import Gyroscope, OdometryNoise, load
from nomad_mj.errors import ConfigError
from nomad_mj.tasks.gyroscope import GyroscopeStream
from nomad_mj.tasks.odometry import Odometry
from nomad_mj.types import FloatArray, Pose, Travel

IDEAL = Gyroscope(0.0, 0.0)
STEP = 0.05


def measured(gyroscope: Gyroscope, headings: FloatArray, seed: int = 0) -> FloatArray:
    stream = GyroscopeStream(gyroscope, 0.0, np.random.default_rng(seed))
    return np.array([stream.turned(heading) for heading in headings.tolist()])


@given(st.lists(st.floats(-1, 1), min_size=1, max_size=50))
def test_without_errors_it_measures_turns_however_often_round(turns: list[float]) -> None:
    headings = np.cumsum(turns)
    wrapped = np.angle(np.exp(1j * headings))  # as a free base tells it
    np.testing.assert_allclose(measured(IDEAL, wrapped), turns, atol=1e-9)


@pytest.mark.parametrize("seconds", [1, 16])
def test_the_angle_walks_with_the_root_of_the_time(seconds: int) -> None:
    rest = np.zeros(round(seconds / STEP))
    walk = Gyroscope(0.01, 0.0)
    ends = np.array([measured(walk, rest, seed).sum() for seed in range(600)])
    assert ends.mean() == pytest.approx(0, abs=4 * 0.01 * math.sqrt(seconds / 600))
    assert ends.std() == pytest.approx(0.01 * math.sqrt(seconds), rel=0.1)


def test_the_bias_keeps_its_size_and_is_forgotten_in_its_time() -> None:
    wander = Gyroscope(0.0, 0.02, correlation_time=1.0)
    rates = np.array([measured(wander, np.zeros(61), seed) for seed in range(3000)]) / STEP
    np.testing.assert_allclose(rates.std(axis=0), 0.02, rtol=0.1)
    for later in (1.0, 2.0):
        alike = np.corrcoef(rates[:, 0], rates[:, round(later / STEP)])[0, 1]
        assert alike == pytest.approx(math.exp(-later), abs=0.07)


steps = st.lists(st.tuples(st.floats(-0.03, 0.03), st.floats(-0.06, 0.06)), min_size=1, max_size=40)


def follow(
    path: list[tuple[float, float]], noise: OdometryNoise, weight: float, exact: bool
) -> FloatArray:
    """Return headings, true and by odometry, at the end of a path."""
    odometry = Odometry(Pose(0, 0, 0.3), noise, np.random.default_rng(0), weight)
    heading = 0.3
    odometry.update(Travel(0.0, 0.0, heading, 0.0), 0.0 if exact else None)
    for distance, turn in path:
        heading += turn
        odometry.update(Travel(distance, 0.0, heading, 0.0), turn if exact else None)
    return np.array([heading, odometry.reading()[2]])


@given(steps, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
def test_the_heading_drifts_by_the_metre_and_by_the_second(
    path: list[tuple[float, float]], per_metre: float, per_second: float
) -> None:
    noise = OdometryNoise(heading_per_metre=per_metre, heading_per_second=per_second)
    true, told = follow(path, noise, 0.0, exact=False)
    metres = sum(distance for distance, _ in path)
    wanted = per_metre * metres + per_second * len(path) * STEP
    assert told - true == pytest.approx(wanted, abs=1e-12)


@given(steps, st.floats(0, 1))
def test_a_gyroscope_leaves_the_share_of_the_drift_that_it_is_not_believed(
    path: list[tuple[float, float]], weight: float
) -> None:
    noise = OdometryNoise(heading=0.05, heading_per_metre=0.1, heading_per_second=0.02)
    true, drifted = follow(path, noise, 0.0, exact=False)
    _, told = follow(path, noise, weight, exact=True)
    assert told - true == pytest.approx((1 - weight) * (drifted - true), abs=1e-9)


def long_drive(robot: str, seconds: float = 40.0, seed: int = 0, **options: Any) -> FloatArray:
    """Return how far odometry's heading and place are off after a drive in circles."""
    task = {"random": seed, "ends_at_goal": False, **options}
    with load("motor", "empty_room", robot, task_kwargs=task) as env:
        step = env.reset(seed=seed, start=(5.0, 4.0, 0.0))
        assert step.observation["odometry"][2] == pytest.approx(0.0)
        for _ in range(round(seconds / STEP)):
            step = env.step((0.3, 0.3, 0.0))
        true, told = env.physics.pose(), step.observation["odometry"]
        off = math.remainder(true.heading - told[2], 2 * math.pi)
        return np.array([abs(off), math.hypot(true.x - told[0], true.y - told[1])])


DRIFTS = OdometryNoise(heading=0.02, heading_per_metre=0.02, heading_per_second=0.002)


@pytest.mark.parametrize("robot", ["nomad200", "nomad200_wheels"])
def test_after_a_long_drive_the_heading_is_much_better_with_a_gyroscope(robot: str) -> None:
    without = np.mean([long_drive(robot, seed=s, odometry_noise=DRIFTS) for s in range(2)], axis=0)
    with_one = [
        long_drive(robot, seed=s, odometry_noise=DRIFTS, gyroscope=Gyroscope()) for s in range(2)
    ]
    assert without[0] > math.radians(10)
    assert (np.mean(with_one, axis=0) < without / 8).all()


def test_its_own_errors_are_what_remains() -> None:
    off = [
        long_drive("nomad200", 20.0, seed, gyroscope=Gyroscope(weight=1.0))[0] for seed in range(8)
    ]
    walk, bias = Gyroscope().angle_random_walk * math.sqrt(20), Gyroscope().bias_instability * 20
    assert 0.2 * math.hypot(walk, bias) < np.mean(off) < 2 * math.hypot(walk, bias)


def test_episodes_depend_on_the_seed_alone() -> None:
    options = {"random": 3, "gyroscope": Gyroscope(), "odometry_noise": DRIFTS}
    with load("motor", "paper_room", task_kwargs=options) as env:
        seen = []
        for _ in range(2):
            env.reset(seed=3, start=0)
            seen.append([env.step((0.2, 0.3, 0.1)).observation["odometry"] for _ in range(20)])
        np.testing.assert_array_equal(seen[0], seen[1])
        env.reset(seed=4, start=0)
        other = [env.step((0.2, 0.3, 0.1)).observation["odometry"] for _ in range(20)]
        assert (np.array(other)[1:, 2] != np.array(seen[0])[1:, 2]).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"angle_random_walk": -1.0}, "gyroscope angle_random_walk -1.0: must be >= 0"),
        ({"bias_instability": math.nan}, "gyroscope bias_instability nan: must be >= 0"),
        ({"correlation_time": 0.0}, "gyroscope correlation_time 0.0: must be above 0 s"),
        ({"weight": 1.1}, "gyroscope weight 1.1: must be in [0, 1]"),
    ],
)
def test_what_makes_no_sense_is_refused(options: dict[str, float], message: str) -> None:
    with pytest.raises(ConfigError) as caught:
        Gyroscope(**options)
    assert str(caught.value) == message


@pytest.mark.parametrize("name", ["heading_per_metre", "heading_per_second"])
def test_drifts_that_make_no_sense_are_refused(name: str) -> None:
    with pytest.raises(ConfigError, match=rf"^odometry noise {name} inf: must be finite$"):
        OdometryNoise(**{name: math.inf})
