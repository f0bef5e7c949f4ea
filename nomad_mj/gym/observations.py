"""What a learner is shown: the situation, or readings and the goal, as numbers a network likes.

They lie in [0, 1] or [-1, 1] and are float32, which is what networks calculate in.
"""

import math
from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from nomad_mj.envs import percept_of
from nomad_mj.perception import SituationSpec, code_ranges
from nomad_mj.scene import CONTROL_TIMESTEP, Scene
from nomad_mj.tasks import MotorTask

FloatArray32 = npt.NDArray[np.float32]


class Observer(Protocol):
    """Turns observations of the environment below into those of a space."""

    @property
    def space(self) -> spaces.Space[Any]:
        """What the observations are elements of."""
        ...

    def __call__(self, observation: Mapping[str, Any], first: bool) -> Any:
        """Return what the learner is shown, in arrays of its own; `first` of an episode or not."""
        ...


class SituationObserver:
    """The situation of section 2.1, (26,) in [0, 1]; oriented as the world."""

    def __init__(self, scene: Scene, spec: SituationSpec) -> None:
        self._layout, self._spec = scene.robot.layout, spec
        self.space = spaces.Box(0.0, 1.0, (spec.size,), np.float32)

    def __call__(self, observation: Mapping[str, Any], first: bool) -> FloatArray32:
        """Return the situation."""
        return percept_of(observation, self._layout, self._spec).situation.astype(np.float32)


class RangesObserver:
    """Readings and the goal as the sensors' frame has it, (C + 3,).

    All range readings as a share of their maximum, in [0, 1]; cosine and sine of the goal's
    direction in the frame of the sensors; exp(-distance / 5 m) to the goal.
    """

    def __init__(self, scene: Scene) -> None:
        self._layout = scene.robot.layout
        low = np.concatenate([np.zeros(scene.robot.layout.count), [-1.0, -1.0, 0.0]])
        self.space = spaces.Box(low.astype(np.float32), np.float32(1.0), dtype=np.float32)

    def __call__(self, observation: Mapping[str, Any], first: bool) -> FloatArray32:
        """Return the readings and where the goal is."""
        ranges = np.concatenate([observation[ring.name] for ring in self._layout.rings])
        sensors = observation["odometry"][3]
        return code_ranges(ranges, sensors, observation["goal"], self._layout)


class DrivenRangesObserver:
    """What `RangesObserver` shows, and how the robot drives, (C + 3 + B + 5,).

    Behind it the bumpers, 0 or 1; cosine and sine of the direction of driving in the frame of the
    sensors; speed forward, to the left and of turning, as a share of the robot's largest.
    """

    def __init__(self, scene: Scene, task: MotorTask) -> None:
        self._ranges = RangesObserver(scene)
        self._task = task
        limits = scene.robot.limits
        self._fastest = (limits.translate, limits.translate, limits.turn)
        self._before = math.nan
        bumpers = len(scene.robot.bumpers)
        low = np.concatenate([self._ranges.space.low, np.zeros(bumpers), -np.ones(5)])
        self.space = spaces.Box(low.astype(np.float32), np.float32(1.0), dtype=np.float32)

    def __call__(self, observation: Mapping[str, Any], first: bool) -> FloatArray32:
        """Return readings, bumpers and speeds."""
        heading, sensors = observation["odometry"][2:].tolist()
        travel = self._task.travel
        turned = 0.0 if first else travel.heading - self._before
        self._before = travel.heading
        speeds = (
            max(-1.0, min(way / (CONTROL_TIMESTEP * fastest), 1.0))
            for way, fastest in zip(
                (travel.forward, travel.sideways, turned), self._fastest, strict=True
            )
        )
        own = (math.cos(heading - sensors), math.sin(heading - sensors), *speeds)
        parts = (self._ranges(observation, first), observation["bumpers"], own)
        return np.concatenate(parts, dtype=np.float32, casting="same_kind")
