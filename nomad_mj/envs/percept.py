"""What is perceived where an observation was made."""

from collections.abc import Mapping

import numpy as np

from nomad_mj.perception import Percept, SituationSpec, perceive
from nomad_mj.types import FloatArray, SensorLayout


def percept_of(
    observation: Mapping[str, FloatArray], layout: SensorLayout, spec: SituationSpec
) -> Percept:
    """Return the percept of an observation of path finding or of the motor task."""
    ranges = np.concatenate([observation[ring.name] for ring in layout.rings])
    return perceive(ranges, observation["odometry"][3], observation["goal"], layout, spec)
