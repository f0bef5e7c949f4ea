"""What is drawn into the room beside the room: path, goal, readings and the move to come."""

import mujoco
import numpy as np

from nomad_mj.arenas import goal_site
from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray, IntArray
from nomad_mj.video.layout import Pane
from nomad_mj.video.marks import Marks, Sheet
from nomad_mj.video.palette import GREEN, INK, PAPER, RGB, range_colours
from nomad_mj.video.trail import Trail

_FAR = 3.0  # [m]; readings from here on look alike
_POLE = 1.5  # [m], higher than the walls: the goal shows behind them
_NEAR_WIDTH, _FAR_WIDTH = 0.05, 0.085  # [m] of the path, seen from near and from far
_GREEN = np.array([[*GREEN, 1.0]])
# Flat things lie over each other in this order [m above the floor].
_PATH, _STOP, _ARROW, _GOAL, _SHADE = 0.010, 0.012, 0.014, 0.011, 0.016


def _axis_sites(scene: Scene) -> IntArray:
    """Return the site of the middle ray of each cone, (C,)."""
    model, rays = scene.model, scene.robot.rays
    kind = mujoco.mjtSensor.mjSENS_RANGEFINDER
    sites = {
        int(model.sensor_adr[s]): int(model.sensor_objid[s])
        for s in np.flatnonzero(model.sensor_type == kind)
    }
    ends = np.append(rays.first[1:], len(rays.address))
    middle = (rays.first + ends - 1) // 2
    return np.array([sites[int(address)] for address in rays.address[middle]], dtype=np.intp)


class Painter:
    """Decorates the panes of a picture.

    Parameters
    ----------
    scene : Scene
        Robot and room.
    unit : float
        Size of the picture (see `Layout`).

    Attributes
    ----------
    trail : Trail or None
        The path so far.
    ranges : array (C,) or None
        The readings of all cones [m]; misses are not drawn.
    move : (start (2,), end (2,), RGB) or None
        The move to come, world frame [m].
    """

    def __init__(self, scene: Scene, unit: float) -> None:
        self.trail: Trail | None = None
        self.ranges: FloatArray | None = None
        self.move: tuple[FloatArray, FloatArray, RGB] | None = None
        self._unit = unit
        self._rays = scene.robot.rays
        self._sites = _axis_sites(scene)
        self._base = scene.robot.footing.base
        self._shade = Sheet()  # nothing casts a shadow of its own
        for grow in (1.35, 1.16):
            radius = grow * scene.robot.layout.radius
            self._shade.disc(np.zeros(2), radius, _SHADE, INK, 0.11)
        self._drawn: dict[float, tuple[Trail, tuple[int, int], Sheet]] = {}
        self._goal = goal_site(scene.model)
        self._goal_marks = Sheet()
        self._goal_marks.dot(np.zeros(2), 0.10, _GOAL, PAPER)
        self._goal_marks.dot(np.zeros(2), 0.05, _GOAL + 0.002, GREEN)

    def decorate(self, data: mujoco.MjData, marks: Marks, pane: Pane) -> None:
        """Add everything to a pane that shows the state `data`."""
        near = pane.camera == "chase"
        width = _NEAR_WIDTH if near else _FAR_WIDTH
        head: FloatArray = data.xpos[self._base][:2]
        now = Sheet()
        if self.trail is not None:
            marks.add(self._past(self.trail, width))
            tail, colour = self.trail.tail
            now.ribbon(np.array([tail, head]), [colour], width, _PATH)
        if self.move is not None:
            start, end, colour = self.move
            now.arrow(start, end, 0.8 * width, _ARROW, colour)
        marks.add(now)
        if near:
            marks.add(self._shade, np.array([*head, 0.0]))
        foot = np.array([*data.site_xpos[self._goal][:2], 0.0])
        top = foot + np.array([0.0, 0.0, _POLE])
        marks.add(self._goal_marks, foot)
        marks.lines(foot[None], top[None], 2.0 * self._unit, _GREEN)
        marks.ball(top, 0.08, GREEN)
        if self.ranges is not None:
            self._draw_rays(data, marks, self.ranges)

    def _past(self, trail: Trail, width: float) -> Sheet:
        """Return the path up to its last bend, drawn anew only when it has grown."""
        points, colours = trail.bends()
        known = self._drawn.get(width)
        if known is not None and known[0] is trail and known[1] == (len(points), len(trail.stops)):
            return known[2]
        sheet = Sheet()
        sheet.ribbon(points, colours, width, _PATH)
        for place, colour in trail.stops:
            sheet.dot(place, 0.85 * width, _STOP, colour)
        self._drawn[width] = trail, (len(points), len(trail.stops)), sheet
        return sheet

    def _draw_rays(self, data: mujoco.MjData, marks: Marks, ranges: FloatArray) -> None:
        starts: FloatArray = data.site_xpos[self._sites]
        axes: FloatArray = data.site_xmat[self._sites][:, 2::3]
        ends = starts + np.maximum(ranges + self._rays.offset, 0.0)[:, None] * axes
        colours = range_colours(ranges, _FAR)
        hits = ranges < 0.999 * self._rays.maximum
        marks.lines(starts[hits], ends[hits], 1.6 * self._unit, colours[hits])
