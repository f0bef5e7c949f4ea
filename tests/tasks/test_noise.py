"""Statistics of the errors of range sensors and of odometry."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nomad_mj import load
from nomad_mj.errors import ConfigError
from nomad_mj.tasks import OdometryNoise, RangeNoise
from nomad_mj.tasks.noise import RangeNoiseKind, RangeNoiseStream
from nomad_mj.tasks.odometry import Odometry
from nomad_mj.types import FloatArray, Pose, Travel


def draws(noise: RangeNoise, rounds: int = 3000, sensors: int = 32, seed: int = 0) -> FloatArray:
    stream = RangeNoiseStream(noise, sensors, np.random.default_rng(seed))
    return np.array([stream.factors() for _ in range(rounds)])


@given(st.sampled_from(["uniform", "gaussian"]), st.floats(0.01, 0.99), st.integers(0, 2**32))
def test_factors_are_never_negative_and_differ_from_round_to_round(
    kind: RangeNoiseKind, level: float, seed: int
) -> None:
    factors = draws(RangeNoise(kind, level), rounds=70, sensors=4, seed=seed)
    assert factors.shape == (70, 4) and (factors >= 0).all()
    assert len(np.unique(factors[:, 0])) > 20
    if kind == "uniform":
        assert np.abs(factors - 1).max() <= level


def test_uniform_noise_fills_its_interval_evenly() -> None:
    factors = draws(RangeNoise("uniform", 0.15))
    assert 0.85 <= factors.min() < 0.851 and 1.149 < factors.max() <= 1.15
    assert factors.mean() == pytest.approx(1, abs=2e-3)
    assert factors.std() == pytest.approx(0.15 / math.sqrt(3), rel=0.01)
    counts, _ = np.histogram(factors, bins=10, range=(0.85, 1.15))
    assert np.abs(counts / counts.mean() - 1).max() < 0.05


def test_gaussian_noise_has_the_deviation_asked_for() -> None:
    factors = draws(RangeNoise("gaussian", 0.1))
    assert factors.mean() == pytest.approx(1, abs=2e-3)
    assert factors.std() == pytest.approx(0.1, rel=0.01)
    assert (np.abs(factors - 1) > 0.1).mean() == pytest.approx(0.317, abs=0.01)


@pytest.mark.parametrize("kind", ["uniform", "gaussian"])
def test_sensors_and_rounds_err_independently(kind: RangeNoiseKind) -> None:
    factors = draws(RangeNoise(kind, 0.15), sensors=4)
    across = np.corrcoef(factors.T) - np.eye(4)
    assert np.abs(across).max() < 0.06
    one = factors[:, 0]
    for lag in (1, 2, 63, 64, 65):  # also over the borders of what is drawn at once
        assert abs(np.corrcoef(one[:-lag], one[lag:])[0, 1]) < 0.06


@pytest.mark.parametrize(
    "noise", [RangeNoise("none"), RangeNoise("uniform", 0), RangeNoise("gaussian", 0)]
)
def test_without_noise_readings_stay_as_they_are(noise: RangeNoise) -> None:
    assert (draws(noise, rounds=200, sensors=3) == 1).all()


def test_the_same_seed_gives_the_same_bits() -> None:
    noise = RangeNoise()
    np.testing.assert_array_equal(draws(noise, 200, seed=5), draws(noise, 200, seed=5))
    assert (draws(noise, 200, seed=5) != draws(noise, 200, seed=6)).any()


@pytest.mark.parametrize("level", [-0.1, 1, 2, math.nan])
def test_levels_that_make_no_sense_are_refused(level: float) -> None:
    with pytest.raises(ConfigError, match=r"^range noise level .*: must be in \[0, 1\)$"):
        RangeNoise("uniform", level)
    with pytest.raises(
        ConfigError, match=r"^range noise 'loud': must be uniform, gaussian or none"
    ):
        RangeNoise("loud")  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["distance", "heading", "position"])
@pytest.mark.parametrize("value", [-1e-3, math.nan])
def test_odometry_noise_that_makes_no_sense_is_refused(name: str, value: float) -> None:
    with pytest.raises(ConfigError, match=rf"^odometry noise {name} .*: must be >= 0$"):
        OdometryNoise(**{name: value})


steps = st.lists(st.tuples(st.floats(-0.03, 0.03), st.floats(-0.06, 0.06)), max_size=40)


def drive(odometry: Odometry, start: Pose, path: list[tuple[float, float]]) -> FloatArray:
    heading = start.heading
    for distance, turn in path:
        heading += turn
        odometry.update(Travel(distance, 0.0, heading, 0.0))
    return odometry.reading()


@given(steps, st.floats(-3, 3), st.floats(-5, 5))
def test_without_noise_odometry_adds_up_what_was_driven(
    path: list[tuple[float, float]], heading: float, x: float
) -> None:
    start = Pose(x, 1.0, heading)
    reading = drive(Odometry(start, OdometryNoise(), np.random.default_rng(0)), start, path)
    place, angle = np.array([x, 1.0]), heading
    for distance, turn in path:  # the chord of each arc, exactly
        middle, bend = angle + turn / 2, np.sinc(turn / 2 / math.pi)
        place = place + distance * bend * np.array([math.cos(middle), math.sin(middle)])
        angle += turn
    np.testing.assert_allclose(reading[:2], place, atol=1e-3 * 0.06**2 * 40)
    assert reading[2] == pytest.approx(angle)


@given(steps, st.floats(-3, 3))
def test_driving_a_way_back_leads_home(path: list[tuple[float, float]], heading: float) -> None:
    start = Pose(1.0, 2.0, heading)
    odometry = Odometry(start, OdometryNoise(), np.random.default_rng(0))
    angle = heading
    headings = [heading := heading + turn for _, turn in path]
    drive(odometry, start, path)
    for (distance, _), before in zip(path[::-1], [*headings[-2::-1], angle], strict=False):
        odometry.update(Travel(-distance, 0.0, before, 0.0))
    np.testing.assert_allclose(odometry.reading()[:2], [1, 2], atol=1e-9)


def ends(noise: OdometryNoise, metres: float, parts: int, robots: int = 800) -> FloatArray:
    """Return the readings (robots, 4) of many that drive straight east by as many metres."""
    start, readings = Pose(0, 0, 0), list[FloatArray]()
    for seed in range(robots):
        odometry = Odometry(start, noise, np.random.default_rng(seed))
        for _ in range(parts):
            odometry.update(Travel(metres / parts, 0.0, 0.0, 0.0))
        readings.append(odometry.reading())
    return np.array(readings)


@pytest.mark.parametrize("parts", [20, 60])
@pytest.mark.parametrize("metres", [1.0, 4.0])
def test_the_heading_drifts_with_the_root_of_the_way_whatever_the_step(
    metres: float, parts: int
) -> None:
    heading = ends(OdometryNoise(heading=0.02), metres, parts)[:, 2]
    assert heading.mean() == pytest.approx(0, abs=4 * 0.02 * math.sqrt(metres / 800))
    assert heading.std() == pytest.approx(0.02 * math.sqrt(metres), rel=0.1)


@pytest.mark.parametrize("parts", [20, 60])
@pytest.mark.parametrize("metres", [1.0, 4.0])
def test_the_distance_errs_with_the_root_of_the_way_whatever_the_step(
    metres: float, parts: int
) -> None:
    x = ends(OdometryNoise(distance=0.05), metres, parts)[:, 0]
    assert x.mean() == pytest.approx(metres, abs=4 * 0.05 * math.sqrt(metres / 800))
    assert x.std() == pytest.approx(0.05 * math.sqrt(metres), rel=0.1)


def test_the_turret_drifts_with_the_robot_and_nothing_drifts_at_rest() -> None:
    odometry = Odometry(Pose(0, 0, 1), OdometryNoise(0.1, 0.1, 0.0), np.random.default_rng(0))
    for _ in range(50):
        odometry.update(Travel(0.0, 0.0, 1.0, 0.3))
    np.testing.assert_array_equal(odometry.reading(), [0, 0, 1, 0.3])
    odometry.update(Travel(0.5, 0.0, 1.0, 0.3))
    _, _, heading, turret = odometry.reading()
    assert heading - 1.0 == pytest.approx(turret - 0.3) and heading != 1.0


def test_positions_err_anew_at_each_reading_within_the_bound_and_do_not_add_up() -> None:
    odometry = Odometry(Pose(1, 2, 0), OdometryNoise(position=2.0), np.random.default_rng(0))
    readings = np.array([odometry.reading() for _ in range(2000)])
    off = readings[:, :2] - [1, 2]
    assert np.abs(off).max() <= 2 and np.abs(off).max() > 1.9
    np.testing.assert_allclose(off.mean(axis=0), 0, atol=0.12)
    np.testing.assert_allclose(off.std(axis=0), 2 / math.sqrt(3), rtol=0.05)
    assert abs(np.corrcoef(off.T)[0, 1]) < 0.08
    assert (readings[:, 2:] == 0).all()


@pytest.mark.parametrize("level", [0.3, 0.9])
def test_what_hits_nothing_reads_the_maximum_however_the_factors_fall(level: float) -> None:
    options = {"range_noise": RangeNoise("gaussian", level), "random": 0}
    with load("motor", "empty_room", task_kwargs=options) as env:
        env.reset(seed=0, start=(5.0, 5.0))
        for _ in range(300):
            infrared = env.step(np.zeros(3)).observation["infrared"]
            assert (infrared == 0.6).all()
