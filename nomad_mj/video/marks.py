"""Flat marks and thin lines added to a scene that mujoco has just updated.

Lines and triangles cost next to nothing on a software renderer; discs, capsules and arrows of
mujoco's own cost as much as the robot.
"""

from collections.abc import Sequence

import mujoco
import numpy as np

from nomad_mj.types import FloatArray
from nomad_mj.video.palette import RGB

_SIDES = 8
_FLAT = np.eye(3)
_ANY = np.ones(3)


class Marks:
    """Adds marks to one scene, as long as it has room for them.

    Parameters
    ----------
    scene : mujoco.MjvScene
        Call `mjv_updateScene` first: it throws away what was added.
    """

    def __init__(self, scene: mujoco.MjvScene) -> None:
        self._scene = scene
        self._geoms = scene.geoms  # a tuple of all places there are; looking it up is slow

    def _add(
        self,
        kind: mujoco.mjtGeom,
        size: FloatArray,
        place: FloatArray,
        axes: FloatArray,
        colour: FloatArray,
    ) -> mujoco.MjvGeom | None:
        """Return a new mark, None where the scene is full: a picture lacks it, nothing breaks."""
        index = self._scene.ngeom
        if index >= self._scene.maxgeom:
            return None
        geom = self._geoms[index]
        mujoco.mjv_initGeom(geom, kind, size, place, axes.ravel(), colour)
        geom.category = mujoco.mjtCatBit.mjCAT_DECOR
        self._scene.ngeom = index + 1
        return geom

    def line(self, start: FloatArray, end: FloatArray, width: float, colour: FloatArray) -> None:
        """Draw a line between two places (3,) [m], `width` pixels wide, in RGBA."""
        kind = mujoco.mjtGeom.mjGEOM_LINE
        geom = self._add(kind, _ANY, start, _FLAT, colour.astype(np.float32))
        if geom is not None:
            mujoco.mjv_connector(geom, kind, width, start, end)

    def triangle(self, corners: FloatArray, height: float, colour: FloatArray) -> None:
        """Draw a triangle on the floor: corners (3, 2), height [m], RGBA."""
        # The unit triangle (0, 0), (1, 0), (0, 1), sheared: its axes need not be orthogonal.
        axes = np.eye(3)
        axes[:2, 0] = corners[1] - corners[0]
        axes[:2, 1] = corners[2] - corners[0]
        place = np.array([corners[0, 0], corners[0, 1], height])
        geom = self._add(mujoco.mjtGeom.mjGEOM_TRIANGLE, _ANY, place, axes, colour)
        if geom is not None:
            geom.emission = 0.35
            geom.specular = 0.0

    def fan(self, outline: FloatArray, height: float, colour: RGB) -> None:
        """Draw a convex polygon (N, 2) on the floor."""
        rgba = np.array([*colour, 1.0], dtype=np.float32)
        for i in range(1, len(outline) - 1):
            self.triangle(outline[[0, i, i + 1]], height, rgba)

    def disc(self, centre: FloatArray, radius: float, height: float, colour: RGB) -> None:
        """Draw a disc on the floor."""
        angle = np.arange(_SIDES) * (2 * np.pi / _SIDES) + np.pi / _SIDES
        outline = centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        self.fan(outline, height, colour)

    def ribbon(
        self, points: FloatArray, colours: Sequence[RGB], width: float, height: float
    ) -> None:
        """Draw a band of constant width [m] along points (N, 2), one colour (N - 1) a piece."""
        steps = np.diff(points, axis=0)
        lengths = np.hypot(steps[:, 0], steps[:, 1])
        for i in np.flatnonzero(lengths > 1e-6):
            side = np.array([-steps[i, 1], steps[i, 0]]) * (width / 2 / lengths[i])
            a, b = points[i], points[i + 1]
            self.fan(np.array([a - side, b - side, b + side, a + side]), height, colours[i])

    def arrow(
        self, start: FloatArray, end: FloatArray, width: float, height: float, colour: RGB
    ) -> None:
        """Draw an arrow on the floor between two places (2,) [m]."""
        span = end - start
        length = float(np.hypot(span[0], span[1]))
        if length < 1e-6:
            return
        along = span / length
        across = np.array([-along[1], along[0]])
        head = min(3.2 * width, length)
        neck = end - head * along
        if length > head:
            self.ribbon(np.array([start, neck]), [colour], width, height)
        wings = np.array([neck - 1.5 * width * across, end, neck + 1.5 * width * across])
        self.fan(wings, height, colour)

    def ball(self, centre: FloatArray, radius: float, colour: RGB) -> None:
        """Draw a ball."""
        rgba = np.array([*colour, 1.0], dtype=np.float32)
        size = np.full(3, radius)
        self._add(mujoco.mjtGeom.mjGEOM_ELLIPSOID, size, centre, _FLAT, rgba)
