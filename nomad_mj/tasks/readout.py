"""Where a robot's sensors are in the engine's arrays, and what they read there.

All arrays have leading dimensions: none for one robot, (N,) for many that drive side by side. What
is read is the same to the bit either way.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from operator import add

import mujoco
import numpy as np
import numpy.typing as npt
from typing_extensions import Self

from nomad_mj.robots import PREFIX, RayIndex, RobotDescription
from nomad_mj.types import FloatArray, IntArray

MISS = 1e6  # [m]
_NO_ECHO = -1.0  # what the engine reads where a ray hits nothing


@dataclass(frozen=True, eq=False)
class Readout:
    """The addresses of a robot's sensors in a compiled model.

    Attributes
    ----------
    rays : RayIndex
        The range sensors' rays, in ``sensordata``.
    surfaces : array (G, 2, 3)
        Behind the distances of the specular rays, there: the direction of the ray, the normal of
        the surface.
    touch : array (K, B)
        The last K samples of each bumper, in ``history``.
    speed_now, speeds : array (W,), (W, K)
        Of each encoder that counts a way: its speed now, in ``sensordata``, and the K samples of
        this control step before it, in ``history``.
    scales : array (W,)
        Way per speed and physics step [m].
    angles : array (A,)
        Angles that encoders tell, in ``qpos``.
    """

    rays: RayIndex
    surfaces: IntArray
    touch: IntArray
    speed_now: IntArray
    speeds: IntArray
    scales: FloatArray
    angles: IntArray

    @classmethod
    def of(cls, model: mujoco.MjModel, robot: RobotDescription) -> Self:
        """Look names up once: the control step reads plain arrays."""
        rays, encoders = robot.rays, robot.encoders
        touch = [int(model.sensor(PREFIX + name).id) for name in robot.bumpers]
        first: IntArray = rays.address[rays.specular, None] + np.arange(1, 7)
        return cls(
            rays=rays,
            surfaces=first.reshape(-1, 2, 3),
            touch=_samples(model, touch),
            speed_now=model.sensor_adr[encoders.speeds].astype(np.intp),
            speeds=np.ascontiguousarray(_samples(model, encoders.speeds.tolist()).T),
            scales=encoders.scales * float(model.opt.timestep),
            angles=encoders.angles,
        )

    def moved(self, history: int, qpos: int) -> Self:
        """Return the same for arrays in which history and positions begin farther on."""
        return replace(
            self,
            touch=self.touch + history,
            speeds=self.speeds + history,
            angles=self.angles + qpos,
        )

    def distances(self, sensordata: FloatArray, grazing: float | None = None) -> FloatArray:
        """Return how far each ray goes from its site, (..., R) [m]; negative: it hits nothing.

        It may be a view of the engine's array.

        Parameters
        ----------
        sensordata : array (..., S)
            The engine's.
        grazing : float, optional
            As of `RangeNoise`: a specular ray whose echo is lost counts as a miss.
        """
        values: FloatArray = sensordata[..., self._ray_span]
        if grazing is not None:
            values = values.copy()
            specular = self.rays.specular
            surfaces = sensordata.take(self.surfaces, axis=-1)
            incidence = np.abs(np.multiply.reduce(surfaces, axis=-2).sum(axis=-1))
            echoes = values.take(specular, axis=-1)
            np.copyto(echoes, _NO_ECHO, where=incidence < math.cos(grazing))
            values[..., specular] = echoes
        return values

    def cones(self, distances: FloatArray) -> FloatArray:
        """Return each cone's shortest ray, (..., C) [m] from the perimeter; a miss: `MISS`."""
        rays = self.rays
        # Read as whole numbers, the bits of floats have the same order, and negative ones come
        # last: one comparison for all that is too far, which the engine cuts to the maximum, and
        # for all that hits nothing.
        shortest = np.minimum.reduceat(distances.view(np.uint64), rays.first, -1)
        cones = shortest.view(np.float64) - rays.offset
        np.copyto(cones, MISS, where=shortest >= self._maximum)
        return cones

    def bumpers(self, history: FloatArray) -> FloatArray:
        """Return 1 for each bumper touched in the control step, else 0, (..., B)."""
        forces = history.take(self.touch, -1)
        if not np.count_nonzero(forces):
            return np.zeros((*forces.shape[:-2], forces.shape[-1]))
        return np.logical_or.reduce(forces, axis=-2).astype(np.float64)

    def encoders(self, sensordata: FloatArray, history: FloatArray, qpos: FloatArray) -> FloatArray:
        """Return what the encoders read, (..., W + A): ways in the step [m], angles [rad]."""
        # Sums one after the other whatever the shape, which neither sum() nor np.sum() promises.
        if history.ndim == 1:  # so few that lists are faster
            ways = [
                (reduce(add, history[past].tolist()) + sensordata.item(now)) * scale
                for past, now, scale in self._ways
            ]
            return np.array(ways + [qpos.item(angle) for angle in self._angles])
        past = np.add.accumulate(history.take(self.speeds, axis=-1), axis=-1)[..., -1]
        ways = (past + sensordata.take(self.speed_now, axis=-1)) * self.scales
        return np.concatenate([ways, qpos.take(self.angles, axis=-1)], axis=-1)

    @cached_property
    def _ray_span(self) -> slice | IntArray:
        return as_span(self.rays.address)

    @cached_property
    def _maximum(self) -> npt.NDArray[np.uint64]:
        return self.rays.maximum.astype(np.float64).view(np.uint64)

    @cached_property
    def _ways(self) -> list[tuple[slice | IntArray, int, float]]:
        spans = map(as_span, self.speeds)
        return list(zip(spans, self.speed_now.tolist(), self.scales.tolist(), strict=True))

    @cached_property
    def _angles(self) -> list[int]:
        return self.angles.tolist()


def as_span(addresses: IntArray) -> slice | IntArray:
    """Return a slice for addresses (n,) that follow one another: several times as fast."""
    first, count = int(addresses[0]) if len(addresses) else 0, len(addresses)
    if np.array_equal(addresses, np.arange(first, first + count)):
        return slice(first, first + count)
    return addresses


def _samples(model: mujoco.MjModel, sensors: list[int]) -> IntArray:
    """Return where in ``data.history`` the last samples of scalar sensors are, (samples, sensors).

    A scalar sensor's buffer holds two numbers of state, the samples' times, then their values.
    """
    count = int(model.sensor_history[sensors[0], 0]) if sensors else 0
    values = np.arange(2 + count, 2 + 2 * count, dtype=np.intp)
    first = np.array([int(model.sensor_historyadr[s]) for s in sensors], dtype=np.intp)
    return values[:, None] + first
