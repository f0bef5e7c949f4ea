"""What tests of all that moves share."""

from collections.abc import Iterator

import pytest
from known_movers import FAST, motor

from nomad_mj import MotorEnvironment, RangeNoise


@pytest.fixture(scope="module")
def env() -> Iterator[MotorEnvironment]:
    """Yield a room in which the goal and obstacles drive fast, seen without noise."""
    made = motor(**FAST, range_noise=RangeNoise("none"))
    yield made
    made.close()
