"""Figures in the style of the paper's: the room from above, paths (Fig 6), actions (Fig 7)."""

import io
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PatchCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Polygon

from nomad_agents.agent import Agent
from nomad_agents.checkpoint import write_atomically
from nomad_agents.episode import percept_of
from nomad_agents.evaluation import Trial
from nomad_agents.training import stream
from nomad_mj.envs import PathFinding
from nomad_mj.motion import displacement
from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray

INK = "#23313f"
OBSTACLE = "#c9ced6"
GOAL = "#1f9e77"
PLANNED = "#d9822b"
UNKNOWN = "#b9442e"
_PATH_COLOURS = ("#2c6fbb", "#6f4aa8", "#c2553d", "#3b8f8a", "#9a7b1c", "#4d5a68")
_ACTIONS = 21  # a stream of random numbers


class LatticeAction(NamedTuple):
    """What an agent does at a place: kind of `Decision`, whether the situation was unknown."""

    place: FloatArray
    move: FloatArray
    kind: str
    unmatched: bool


def _room_axes(scene: Scene, title: str) -> tuple[Figure, Axes]:
    """Return a figure with the room seen from above, in metres, and the goal."""
    x0, y0, x1, y1 = scene.plan.bounds.tolist()
    width = 6.4
    figure = Figure(figsize=(width, width * (y1 - y0) / (x1 - x0) + 0.75), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    patches = [Polygon(shapely.get_coordinates(shape)) for shape in scene.plan.footprints]
    axes.add_collection(PatchCollection(patches, facecolor=OBSTACLE, edgecolor=OBSTACLE))
    x, y = scene.arena.goal.tolist()
    side = 0.36
    axes.add_patch(
        Polygon(
            [
                (x + dx * side / 2, y + dy * side / 2)
                for dx, dy in ((-1, -1), (1, -1), (1, 1), (-1, 1))
            ],
            facecolor=GOAL,
            edgecolor="none",
            zorder=5,
        )
    )
    axes.set(xlim=(x0, x1), ylim=(y0, y1), aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axes.set_title(title, loc="left", fontsize=12, color=INK)
    axes.tick_params(length=0, labelsize=9, colors=INK)
    for spine in axes.spines.values():
        spine.set_visible(False)
    return figure, axes


def _save(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the file's suffix, whole or not at all."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format=path.suffix[1:], dpi=160)
    write_atomically(path, lambda file: file.write(buffer.getvalue()))


def draw_paths(scene: Scene, trials: list[Trial], path: Path, title: str) -> None:
    """Draw the ways of some episodes (Fig 6), a dot where each starts.

    Parameters
    ----------
    scene : Scene
        The room and the robot.
    trials : list of Trial
        Their true tracks are drawn; dashed red where the goal was not reached.
    path : Path
        A .png, .pdf or .svg file.
    title : str
        Stands above.
    """
    figure, axes = _room_axes(scene, title)
    radius = scene.robot.layout.radius
    for number, trial in enumerate(trials):
        reached = trial.episode.reached
        colour = _PATH_COLOURS[number % len(_PATH_COLOURS)] if reached else UNKNOWN
        style = "-" if reached else "--"
        axes.plot(*trial.track.T, style, color=colour, linewidth=1.6, alpha=0.85, zorder=3)
        centre = (float(trial.track[0, 0]), float(trial.track[0, 1]))
        axes.add_patch(
            Circle(centre, radius, facecolor="white", edgecolor=colour, lw=1.4, zorder=4)
        )
    handles = [
        Line2D([], [], marker="o", ls="", mfc="white", mec=INK, ms=9, label="start (robot's size)"),
        Line2D([], [], marker="s", ls="", color=GOAL, ms=8, label="goal"),
    ]
    _legend(figure, handles)
    _save(figure, path)


def _legend(figure: Figure, handles: list[Line2D]) -> None:
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles), frameon=False, fontsize=9
    )


def lattice(scene: Scene, spacing: float, clearance: float = 0.05) -> FloatArray:
    """Return the places (n, 2) of a square lattice [m] where the robot fits and can go on."""
    x0, y0, x1, y1 = scene.free_space.bounds
    xs, ys = (np.arange(low + spacing / 4, high, spacing) for low, high in ((x0, x1), (y0, y1)))
    places = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    fits = scene.plan.clearance(places, scene.robot.layout.radius) > clearance
    return places[fits & shapely.contains_xy(scene.free_space, places)]


def lattice_actions(
    env: PathFinding, agent: Agent, places: FloatArray, seed: int
) -> list[LatticeAction]:
    """Return what a greedy agent does at each of the places (n, 2), with real readings there."""
    actions: list[LatticeAction] = []
    for number, place in enumerate(places):
        step = env.reset(stream(seed, _ACTIONS, number), tuple(place.tolist()))
        percept = percept_of(step.observation, agent.layout, agent.situation)
        agent.start_episode()
        decision = agent.act(percept, None)
        move = displacement(decision.action, percept.goal, env.config.action)
        actions.append(LatticeAction(place, move, decision.kind, decision.unmatched))
    return actions


def draw_actions(scene: Scene, actions: list[LatticeAction], path: Path, title: str) -> None:
    """Draw the action taken at each place (Fig 7): a circle, and a line along the move."""
    figure, axes = _room_axes(scene, title)
    groups = {
        "learnt reaction": (INK, [a for a in actions if a.kind == "reacted" and not a.unmatched]),
        "nearest reaction": (PLANNED, [a for a in actions if a.kind == "reacted" and a.unmatched]),
        "planned: situation unknown": (PLANNED, [a for a in actions if a.kind == "planned"]),
        "does not know": (UNKNOWN, [a for a in actions if a.kind == "none"]),
    }
    handles: list[Line2D] = []
    for label, (colour, members) in groups.items():
        if not members:
            continue
        places = np.array([a.place for a in members])
        if label != "does not know":
            # Drawn at 0.4 of their length, so that neighbours stay apart.
            ends = places + 0.4 * np.array([a.move for a in members])
            lines = LineCollection(list(np.stack([places, ends], axis=1)), colors=colour, lw=1.2)
            axes.add_collection(lines)
        axes.plot(*places.T, "o", ms=4.6, mfc="white", mec=colour, mew=1.2, zorder=4)
        handles.append(
            Line2D([], [], marker="o", color=colour, mfc="white", lw=1.2, ms=5, label=label)
        )
    handles.append(Line2D([], [], marker="s", ls="", color=GOAL, ms=8, label="goal"))
    _legend(figure, handles)
    _save(figure, path)
