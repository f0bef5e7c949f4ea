"""Film strips (Figs 11, 12): the room from above at a few times, everything with its trail."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle

from nomad_agents.experiments.figures.room import (
    draw_goal,
    draw_plan,
    draw_robot,
    goal_sign,
    robot_sign,
    room_height,
)
from nomad_agents.experiments.pictures import Film
from nomad_agents.studies.style import BLUE, GOAL, INK, ORANGE, legend_below, sheet
from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray

_COLUMNS, _PANELS = 3, 6
_PANEL = 3.1  # [in] wide
_LAG = 0.5  # [s] over which a direction is taken
_STILL = 0.02  # [m] in that time
_POINTER = 0.55  # [m]
_LONG = 20.0  # [s] from which on no tenths are told


def draw_film(scene: Scene, film: Film, path: Path, title: str) -> None:
    """Draw an episode at six times from its begin to its end.

    Parameters
    ----------
    scene : Scene
        The room and the robot.
    film : Film
        What moved; the trails lead up to each panel's time, faint before the panel before it.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    title : str
        Stands above.
    """
    times = np.array(film["times"])
    shown = np.linspace(times[0], times[-1], _PANELS)
    frames = [int(np.argmin(np.abs(times - time))) for time in shown]
    height = 2 * (room_height(scene, _PANEL) + 0.25) + 0.7
    with sheet(path, _COLUMNS * _PANEL, height) as figure:
        figure.set_layout_engine("constrained", h_pad=0.09)
        panels = figure.subplots(_PANELS // _COLUMNS, _COLUMNS).ravel().tolist()
        digits = 0 if times[-1] > _LONG else 1
        for axes, since, frame in zip(panels, [0, *frames], frames, strict=False):
            draw_plan(axes, scene)
            axes.set(xticks=[], yticks=[])
            axes.set_title(f"{times[frame]:.{digits}f} s", fontsize=12)
            _draw_frame(axes, film, since, frame, scene.robot.layout.radius)
        _draw_scale(panels[0], scene)
        figure.suptitle(title, x=0.006, ha="left", fontsize=13)
        legend_below(figure, _signs(film))


def _draw_frame(axes: Axes, film: Film, since: int, frame: int, radius: float) -> None:
    robot = np.array(film["robot"])[: frame + 1]
    goal = np.array(film["goal"])[: frame + 1]
    _draw_trail(axes, robot[:, :2], since, BLUE)
    _draw_trail(axes, goal, since, GOAL)
    draw_goal(axes, goal[-1])
    draw_robot(axes, robot[-1, :2].tolist(), radius, BLUE, float(robot[-1, 2]))
    times = np.array(film["times"])
    last = len(times) - 1
    now = times[frame] + np.array([-_LAG, _LAG])
    before, after = np.clip(np.searchsorted(times, now), 0, last).tolist()
    for number in range(len(film["obstacles"][frame])):
        track = np.array([places[number] for places in film["obstacles"]])
        _draw_trail(axes, track[: frame + 1], since, ORANGE)
        _draw_obstacle(axes, track[frame], track[after] - track[before], film["radius"])


def _draw_trail(axes: Axes, track: FloatArray, since: int, colour: str) -> None:
    """Draw where something has been (n, 2), faint before the frame `since`."""
    axes.plot(*track[: since + 1].T, color=colour, lw=1.6, alpha=0.3, zorder=3)
    axes.plot(*track[since:].T, color=colour, lw=1.8, zorder=4)


def _draw_obstacle(axes: Axes, place: FloatArray, step: FloatArray, radius: float) -> None:
    """Draw a disc, and an arrow to where it has been heading."""
    x, y = place.tolist()
    axes.add_patch(Circle((x, y), radius, facecolor=ORANGE, edgecolor="none", zorder=5))
    length = float(np.hypot(*step))
    if length > _STILL:
        rim = place + step / length * radius
        tip = rim + step / length * _POINTER
        axes.annotate(
            "",
            tuple(tip.tolist()),
            tuple(rim.tolist()),
            arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 1.2, "shrinkA": 0, "shrinkB": 0},
            zorder=6,
        )


def _draw_scale(axes: Axes, scene: Scene) -> None:
    """Draw a bar of two metres in a lower corner, in the place of numbers along the sides."""
    x0, y0, _, _ = scene.shown_bounds
    x, y = x0 + 0.45, y0 + 0.45
    axes.plot([x, x + 2], [y, y], color=INK, lw=2, solid_capstyle="butt", zorder=8)
    axes.text(x + 1, y + 0.12, "2 m", ha="center", va="bottom", fontsize=10, zorder=8)


def _signs(film: Film) -> Sequence[Line2D]:
    signs = [robot_sign("robot and its way"), goal_sign()]
    signs[0].set(color=BLUE, markeredgecolor=BLUE, linestyle="-", linewidth=1.8)
    if film["obstacles"] and film["obstacles"][0]:
        obstacle = Line2D([], [], marker="o", color=ORANGE, lw=1.8, ms=9, label="moving obstacle")
        signs.append(obstacle)
    return signs
