"""All observations in their units, for wrappers of the user's and for networks of several inputs.

They are float64 and have the bits of the environment below, within limits that are finite.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from dm_env import specs
from gymnasium import spaces

from nomad_mj.arenas.floor_plan import OPEN_ROOM_MARGIN
from nomad_mj.geometry import wrap_angle
from nomad_mj.scene import CONTROL_TIMESTEP, Scene
from nomad_mj.types import FloatArray

FARTHEST_DRIVEN = 10.0  # [m] in a move, which is 1 m long by default


class EverythingObserver:
    """A dictionary of all observations, one-dimensional arrays and ``outcome``.

    What has no limit in the environment below is given one: places reach 10 m beyond the room,
    directions are wrapped into [-pi, pi]. Observations without a number, such as those of bumpers
    that a robot does not have, are left out.

    Parameters
    ----------
    scene : Scene
        Robot and room.
    observation_spec : mapping
        Of the environment below.
    """

    def __init__(self, scene: Scene, observation_spec: Mapping[str, specs.Array]) -> None:
        limits = _limits(scene)
        angles = {"odometry": 2, "encoders": len(scene.robot.encoders.speeds)}
        self.space = spaces.Dict(
            {
                name: _space(spec, limits.get(name))
                for name, spec in observation_spec.items()
                if 0 not in spec.shape
            }
        )
        # Only what has been given limits here can be beyond them.
        self._cut: list[tuple[str, FloatArray, FloatArray, int | None]] = []
        self._arrays: list[tuple[str, tuple[int, ...]]] = []
        self._numbers: list[str] = []
        for name, space in self.space.items():
            if not isinstance(space, spaces.Box):
                self._numbers.append(name)
                continue
            self._arrays.append((name, space.shape))
            if name in limits:
                self._cut.append((name, space.low, space.high, angles.get(name)))

    def __call__(self, observation: Mapping[str, Any], first: bool) -> dict[str, Any]:
        """Return copies of the observations, within their limits."""
        result: dict[str, Any] = {
            name: np.array(observation[name], dtype=np.float64).reshape(shape)
            for name, shape in self._arrays
        }
        for name in self._numbers:
            result[name] = np.int64(observation[name])
        for name, low, high, angles in self._cut:
            value = result[name]
            if angles is not None:
                _wrap(value[angles:])
            np.maximum(np.minimum(value, high, out=value), low, out=value)
        return result


def _wrap(angles: FloatArray) -> None:
    """Make angles the same directions in [-pi, pi]; those that lie there keep their bits."""
    for number, angle in enumerate(angles.tolist()):
        if abs(angle) > math.pi:
            angles[number] = wrap_angle(angle)


def _limits(scene: Scene) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return the limits of the observations that have none of their own, lower and upper."""
    corners = scene.plan.bounds.reshape(2, 2)  # NaN where nothing stands
    places = np.concatenate([corners, scene.arena.starts[:, :2], scene.arena.goal[None]])
    low = np.nanmin(places, axis=0) - OPEN_ROOM_MARGIN
    high = np.nanmax(places, axis=0) + OPEN_ROOM_MARGIN
    turn = np.full(2, math.pi)
    robot = scene.robot
    # Twice what the robot can drive and turn: motors overshoot, wheels slip.
    fastest = robot.limits.translate + robot.limits.turn * robot.layout.radius
    encoders = np.full(len(robot.drive.encoders), 2 * fastest * CONTROL_TIMESTEP)
    encoders[len(robot.encoders.speeds) :] = math.pi  # they read angles
    longest = max(ring.max_range for ring in robot.layout.rings)
    return {
        "odometry": (np.concatenate([low, -turn]), np.concatenate([high, turn])),
        "goal": (low - high, high - low),
        "encoders": (-encoders, encoders),
        "clearance": (np.array(0.0), np.array(longest)),
        "driven": (np.array(0.0), np.array(FARTHEST_DRIVEN)),
    }


def _space(spec: specs.Array, limits: tuple[FloatArray, FloatArray] | None) -> spaces.Space[Any]:
    if isinstance(spec, specs.DiscreteArray):
        return spaces.Discrete(int(spec.num_values))
    if limits is None:
        assert isinstance(spec, specs.BoundedArray), spec
        limits = spec.minimum, spec.maximum
    shape = spec.shape or (1,)
    low, high = (np.broadcast_to(np.asarray(limit, np.float64), shape).copy() for limit in limits)
    return spaces.Box(low, high, dtype=np.float64)
