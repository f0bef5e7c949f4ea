"""Under which conditions a robot drives: what moves, and how its sensors err."""

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from nomad_mj import (
    BumperNoise,
    Crosstalk,
    InfraredEffects,
    MovingGoal,
    MovingObstacles,
    OdometryNoise,
    RangeNoise,
    SonarEffects,
    Walkers,
)
from nomad_mj.errors import UnknownNameError
from nomad_mj.types import SensorLayout

USUAL = "usual"
_POOR_RANGES: dict[str, Any] = {
    # Twice the noise of the paper, and smooth walls: an echo comes back from within 45 degrees.
    "range_noise": RangeNoise("gaussian", 0.3, grazing=math.radians(45)),
    "sonar": SonarEffects(crosstalk=Crosstalk(0.1), dropout=0.1),
    "infrared": InfraredEffects(),
}
_POOR_ODOMETRY: dict[str, Any] = {
    "odometry_noise": OdometryNoise(position=0.3, heading_per_metre=math.radians(1)),
}

CONDITIONS: Mapping[str, Mapping[str, Any]] = MappingProxyType(
    {
        USUAL: {},
        "moving goal": {"moving_goal": MovingGoal()},
        "moving obstacles": {"moving_obstacles": MovingObstacles(count=4)},
        "people": {"moving_obstacles": Walkers(count=3)},
        "poor ranges": _POOR_RANGES,
        "poor odometry": _POOR_ODOMETRY,
        "poor sensors": _POOR_RANGES | _POOR_ODOMETRY | {"bumper_noise": BumperNoise(hold=0.5)},
    }
)
"""Task options of `nomad_mj.load`, by the name of the condition."""


def find_condition(name: str) -> dict[str, Any]:
    """Return the task options of a condition; raise UnknownNameError if there is none."""
    if name not in CONDITIONS:
        raise UnknownNameError("condition", name, CONDITIONS)
    return dict(CONDITIONS[name])


def condition_of(name: str, layout: SensorLayout) -> dict[str, Any]:
    """Return the task options of a condition for a robot: what its sensors have can err."""
    options = find_condition(name)
    rings = {ring.name for ring in layout.rings}
    for effects in ("sonar", "infrared"):
        if effects in options and not rings.issuperset(options[effects].rings):
            del options[effects]
    noise = options.get("range_noise")
    if noise is not None and not rings.issuperset(noise.specular_rings):
        options["range_noise"] = replace(noise, grazing=None)
    return options
