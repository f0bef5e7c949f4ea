"""Infrared sensors that take little light for a long way: dark obstacles seem farther off."""

from dataclasses import dataclass

import mujoco
import numpy as np

from nomad_mj.errors import ConfigError
from nomad_mj.option_types import check_fields
from nomad_mj.robots import RobotDescription
from nomad_mj.tasks.rings import ring_slices
from nomad_mj.types import FloatArray, IntArray

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of red, green and blue: ITU-R BT.709
_UNSET = np.array([0.5, 0.5, 0.5, 1.0])  # a geom's own colour counts where it is not this
_DARKEST = 0.01  # no paint is blacker


@dataclass(frozen=True)
class InfraredEffects:
    """How infrared sensors judge distance by the light that comes back.

    The light that returns from a matt surface goes with its reflectance and with 1 / d^2
    (G. Benet, F. Blanes, J. E. Simo and P. Perez, "Using infrared sensors for distance measurement
    in mobile robots", Robotics and Autonomous Systems 40 (2002)). A sensor that was calibrated on
    a surface of reflectance r0 reads d sqrt(r0 / r) of another one; what sends back less light than
    that surface does from the sensor's maximum range is not seen at all.

    The reflectance is the luminance of the obstacle's colour, the geom's own or its material's, as
    far as light that nobody sees follows the colours that one does; textures do not count, nor how
    a surface lies. Nothing beyond the maximum range is seen, however bright.

    Attributes
    ----------
    rings : tuple of str
        Names of the rings concerned.
    reference : float
        Reflectance r0 of the surface that reads true, in (0, 1]; white paper has 0.9.
    """

    rings: tuple[str, ...] = ("infrared",)
    reference: float = 0.9

    def __post_init__(self) -> None:
        check_fields(self)
        if not 0 < self.reference <= 1:
            raise ConfigError(f"infrared reference {self.reference}: must be in (0, 1]")
        if not self.rings:
            raise ConfigError("infrared effects: need a ring in rings")


def reflectances(model: mujoco.MjModel, geoms: IntArray) -> FloatArray:
    """Return the reflectance of some geoms (n,), each in [0.01, 1]."""
    rgba: FloatArray = model.geom_rgba[geoms].astype(np.float64)
    material = model.geom_matid[geoms]
    by_material = (material >= 0) & np.isclose(rgba, _UNSET).all(axis=1)
    rgba[by_material] = model.mat_rgba[material[by_material]]
    return np.clip(rgba[:, :3] @ _LUMINANCE, _DARKEST, 1.0)


class Infrared:
    """The light that comes back to each ray of some rings.

    The engine's range sensors do not tell what they hit. The rays that hit something near enough,
    few at a time, are cast again.

    Parameters
    ----------
    effects : InfraredEffects
        How the sensors judge.
    model : mujoco.MjModel
        Robot and room.
    robot : RobotDescription
        The robot.

    Raises
    ------
    ConfigError
        The robot lacks a ring.
    """

    def __init__(
        self, effects: InfraredEffects, model: mujoco.MjModel, robot: RobotDescription
    ) -> None:
        rays = robot.rays
        ends = np.append(rays.first, len(rays.address))
        cones = [
            cone
            for _, part in ring_slices("infrared", effects.rings, robot.layout)
            for cone in range(part.start, part.stop)
        ]
        members = [np.arange(ends[cone], ends[cone + 1]) for cone in cones]
        self._rays: IntArray = np.concatenate(members)
        self._maximum = np.concatenate(
            [
                np.full(len(own), rays.maximum[cone])
                for cone, own in zip(cones, members, strict=True)
            ]
        )
        sensors = np.searchsorted(model.sensor_adr, rays.address[self._rays])
        self._sites: list[int] = model.sensor_objid[sensors].tolist()
        self._bodies: list[int] = model.site_bodyid[self._sites].tolist()
        self._reference = effects.reference
        self._struck = np.full(1, -1, dtype=np.int32)

    def judge(
        self, distances: FloatArray, model: mujoco.MjModel, data: mujoco.MjData
    ) -> FloatArray:
        """Return how far rays seem to go, (R,) [m] from their sites, given how far they do."""
        own = distances[self._rays]
        near = np.flatnonzero((own >= 0) & (own < self._maximum)).tolist()
        struck: dict[int, int] = {}  # by ray
        for ray in near:
            site = self._sites[ray]
            along = data.site_xmat[site][2::3]
            mujoco.mj_ray(
                model,
                data,
                data.site_xpos[site],
                along,
                None,
                True,
                self._bodies[ray],
                self._struck,
            )
            if self._struck[0] >= 0:
                struck[ray] = int(self._struck[0])
        if struck:
            # As the model is now: in a large room its geoms change, see `Nearby`.
            light = reflectances(model, np.array([*struck.values()]))
            distances = distances.copy()
            distances[self._rays[[*struck]]] *= np.sqrt(self._reference / light)
        return distances
