"""Flat marks and thin lines added to a scene that mujoco has just updated.

Lines and triangles cost next to nothing on a software renderer; discs, capsules and arrows of
mujoco's own cost as much as the robot.
"""

from collections.abc import Sequence
from itertools import pairwise

import mujoco
import numpy as np
import numpy.typing as npt

from nomad_mj.types import FloatArray
from nomad_mj.video.palette import RGB

_SIDES, _ROUND = 8, 24  # sides of a dot, of a disc
_FLAT = np.eye(3).ravel()
_ANY = np.ones(3)


def _circle(sides: int) -> FloatArray:
    angle = np.arange(sides) * (2 * np.pi / sides)
    return np.stack([np.cos(angle), np.sin(angle)], axis=-1)


class Sheet:
    """Coloured triangles on the floor, worked out once and added to many scenes."""

    def __init__(self) -> None:
        self.triangles: list[tuple[FloatArray, FloatArray, npt.NDArray[np.float32]]] = []

    def fan(self, outline: FloatArray, height: float, colour: RGB, opacity: float = 1.0) -> None:
        """Fill a convex polygon (N, 2) [m] at a height [m]."""
        rgba = np.array([*colour, opacity], dtype=np.float32)
        x, y = outline[0].tolist()
        place = np.array([x, y, height])
        sides = (outline[1:] - outline[0]).tolist()
        for (ax, ay), (bx, by) in pairwise(sides):
            # The unit triangle (0, 0), (1, 0), (0, 1), sheared: its axes need not be orthogonal.
            axes = np.array([ax, bx, 0.0, ay, by, 0.0, 0.0, 0.0, 1.0])
            self.triangles.append((place, axes, rgba))

    def dot(self, centre: FloatArray, radius: float, height: float, colour: RGB) -> None:
        """Draw a small disc around `centre` (2,)."""
        self.fan(centre + radius * _circle(_SIDES), height, colour)

    def disc(
        self, centre: FloatArray, radius: float, height: float, colour: RGB, opacity: float
    ) -> None:
        """Draw a large, translucent disc around `centre` (2,)."""
        self.fan(centre + radius * _circle(_ROUND), height, colour, opacity)

    def ribbon(
        self, points: FloatArray, colours: Sequence[RGB], width: float, height: float
    ) -> None:
        """Draw a band of constant width [m] along points (N, 2), one colour (N - 1) a piece."""
        steps = np.diff(points, axis=0)
        lengths = np.hypot(steps[:, 0], steps[:, 1])
        for i in np.flatnonzero(lengths > 1e-6).tolist():
            side = np.array([-steps[i, 1], steps[i, 0]]) * (width / 2 / lengths[i])
            a, b = points[i], points[i + 1]
            self.fan(np.array([a - side, b - side, b + side, a + side]), height, colours[i])

    def arrow(
        self, start: FloatArray, end: FloatArray, width: float, height: float, colour: RGB
    ) -> None:
        """Draw an arrow between two places (2,) [m]."""
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


class Marks:
    """Adds marks to one scene, as long as it has room: a picture lacks the rest, nothing breaks.

    Parameters
    ----------
    scene : mujoco.MjvScene
        Call `mjv_updateScene` first: it throws away what was added.
    """

    def __init__(self, scene: mujoco.MjvScene) -> None:
        self._scene = scene
        self._geoms = scene.geoms  # a tuple of all places there are; looking it up is slow

    def add(self, sheet: Sheet, shift: FloatArray | None = None) -> None:
        """Add a sheet of triangles, moved by `shift` (3,) [m]."""
        first, most = self._scene.ngeom, self._scene.maxgeom
        kind, init = mujoco.mjtGeom.mjGEOM_TRIANGLE, mujoco.mjv_initGeom
        triangles = sheet.triangles[: most - first]
        for geom, (place, axes, rgba) in zip(self._geoms[first:most], triangles, strict=False):
            init(geom, kind, _ANY, place if shift is None else place + shift, axes, rgba)
        self._scene.ngeom = first + len(triangles)

    def lines(
        self, starts: FloatArray, ends: FloatArray, width: float, colours: FloatArray
    ) -> None:
        """Draw lines between places (N, 3) [m], `width` pixels wide, in RGBA (N, 4)."""
        kind = mujoco.mjtGeom.mjGEOM_LINE
        rgba = colours.astype(np.float32)
        for start, end, colour in zip(starts, ends, rgba, strict=True):
            geom = self._place()
            if geom is None:
                return
            mujoco.mjv_initGeom(geom, kind, _ANY, start, _FLAT, colour)
            mujoco.mjv_connector(geom, kind, width, start, end)

    def ball(self, centre: FloatArray, radius: float, colour: RGB) -> None:
        """Draw a ball around `centre` (3,)."""
        geom = self._place()
        if geom is not None:
            kind, size = mujoco.mjtGeom.mjGEOM_ELLIPSOID, np.full(3, radius)
            rgba = np.array([*colour, 1.0], dtype=np.float32)
            mujoco.mjv_initGeom(geom, kind, size, centre, _FLAT, rgba)

    def _place(self) -> mujoco.MjvGeom | None:
        index = self._scene.ngeom
        if index >= self._scene.maxgeom:
            return None
        self._scene.ngeom = index + 1
        return self._geoms[index]
