"""A robot from above: what collides, where its rays go, its bumpers."""

import math
from pathlib import Path

import mujoco
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon, Wedge

from nomad_agents.studies.style import (
    BLUE,
    INK,
    OBSTACLE,
    ORANGE,
    RED,
    VIOLET,
    WIDTH,
    legend_below,
    sheet,
)
from nomad_mj.robots import PREFIX, reach, robot_geoms
from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray, Pose

_AROUND = np.linspace(0.0, 2 * np.pi, 145)
_COLOURS = (BLUE, ORANGE, VIOLET, RED)
_SHOWN = 1.6  # radii around the robot that the picture shows


def draw_robot_card(scene: Scene, path: Path) -> None:
    """Draw the robot of a scene from above, ahead upwards, as PDF and PNG.

    Parameters
    ----------
    scene : Scene
        Robot and any room.
    path : Path
        Without a suffix.
    """
    data = mujoco.MjData(scene.model)
    scene.robot.footing.place(data.qpos, Pose(0.0, 0.0, math.pi / 2))
    mujoco.mj_kinematics(scene.model, data)
    mujoco.mj_comPos(scene.model, data)
    radius = scene.robot.layout.radius
    with sheet(path, WIDTH, WIDTH + 0.9) as figure:
        axes = figure.subplots()
        _draw_shape(axes, scene, data)
        signs = _draw_rays(axes, scene)
        signs += _draw_bumpers(axes, scene, data)
        edge = _SHOWN * radius
        axes.set(xlim=(-edge, edge), ylim=(-edge, edge), aspect="equal", xlabel="[m]")
        axes.set_title(
            f"{scene.robot.name}: {scene.robot.drive.kind}, radius {radius:g} m, seen from above"
        )
        axes.tick_params(length=0)
        axes.spines[:].set_visible(False)
        legend_below(figure, signs, 2)


def _outline(scene: Scene, data: mujoco.MjData, geom: int) -> FloatArray:
    """Return the outline of a geom from above, (points, 2) [m]: where its tangents meet."""
    ways = np.stack([np.cos(_AROUND), np.sin(_AROUND), np.zeros_like(_AROUND)], axis=1)
    support = np.array([reach(scene.model, data, geom, way) for way in ways])
    slope = np.gradient(support, _AROUND)
    slope[[0, -1]] = (support[1] - support[-2]) / (2 * (_AROUND[1] - _AROUND[0]))
    x = support * ways[:, 0] - slope * ways[:, 1]
    y = support * ways[:, 1] + slope * ways[:, 0]
    return np.stack([x, y], axis=1)


def _draw_shape(axes: Axes, scene: Scene, data: mujoco.MjData) -> None:
    """Draw the geoms that collide, the perimeter, and which way is ahead."""
    model, radius = scene.model, scene.robot.layout.radius
    solid = [g for g in robot_geoms(model) if model.geom_contype[g] or model.geom_conaffinity[g]]
    shapes = [Polygon(_outline(scene, data, geom)) for geom in solid]
    axes.add_collection(
        PatchCollection(shapes, facecolor=OBSTACLE, edgecolor=INK, lw=0.8, alpha=0.7)
    )
    axes.add_patch(Circle((0, 0), radius, fill=False, edgecolor=INK, lw=1.2, ls=(0, (4, 3))))
    axes.annotate(
        "",
        (0, 0.62 * radius),
        (0, 0),
        arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 1.6, "mutation_scale": 18},
        zorder=6,
    )


def _draw_rays(axes: Axes, scene: Scene) -> list[Line2D]:
    """Draw the cones; those of one ring are a colour and as long as no other."""
    radius = scene.robot.layout.radius
    signs: list[Line2D] = []
    for number, ring in enumerate(scene.robot.layout.rings):
        colour = _COLOURS[number % len(_COLOURS)]
        far = radius * (1.5 - 0.2 * (number % 3))
        ends: list[list[tuple[float, float]]] = []
        for bearing in ring.bearings:
            ahead, half = bearing + math.pi / 2, math.degrees(ring.half_angle)
            middle = math.degrees(ahead)
            cone = Wedge((0, 0), far, middle - half, middle + half, width=far - radius)
            cone.set(color=colour, alpha=0.13, lw=0)
            axes.add_patch(cone)
            ends.append([(r * math.cos(ahead), r * math.sin(ahead)) for r in (radius, far)])
        axes.add_collection(LineCollection(ends, colors=colour, linewidths=1.2))
        label = f"{ring.name}: {len(ring.bearings)}, {ring.min_range:g} to {ring.max_range:g} m"
        signs.append(Line2D([], [], color=colour, lw=2, label=label))
    return signs


def _draw_bumpers(axes: Axes, scene: Scene, data: mujoco.MjData) -> list[Line2D]:
    """Draw a mark where each bumper is."""
    model = scene.model
    sites = [int(model.sensor(PREFIX + name).objid[0]) for name in scene.robot.bumpers]
    if not sites:
        return []
    places = np.array([data.site_xpos[site][:2] for site in sites])
    axes.plot(*places.T, ls="", marker="s", ms=6, color=RED, zorder=5)
    return [Line2D([], [], ls="", marker="s", ms=6, color=RED, label=f"bumpers: {len(sites)}")]
