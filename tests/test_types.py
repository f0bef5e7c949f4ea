"""What tells a robot's sensors from another's."""

from dataclasses import replace

import numpy as np

from nomad_mj.types import RangeRing, SensorLayout

RING = RangeRing("sonar", (0.0, 0.39269908169872425), 0.26, 0.15, 6.5)
LAYOUT = SensorLayout(0.265, (RING,))


def test_sensors_match_though_another_processor_rounds_otherwise() -> None:
    rounded = replace(RING, bearings=(-1.1e-17, float(np.nextafter(RING.bearings[1], 1.0))))
    assert SensorLayout(0.265, (rounded,)) != LAYOUT
    assert SensorLayout(0.265, (rounded,)).matches(LAYOUT)


def test_other_sensors_do_not_match() -> None:
    for ring in (
        replace(RING, name="infrared"),
        replace(RING, bearings=(0.0,)),
        replace(RING, bearings=(0.0, 0.4)),
        replace(RING, half_angle=0.2),
        replace(RING, max_range=6.0),
    ):
        assert not SensorLayout(0.265, (ring,)).matches(LAYOUT)
    assert not SensorLayout(0.26, (RING,)).matches(LAYOUT)
    assert not SensorLayout(0.265, (RING, RING)).matches(LAYOUT)
