"""Places all over a room, at which an agent is asked what it does, and whether that is suitable."""

from collections.abc import Sequence

import numpy as np
import shapely

from nomad_agents.experiments.pictures import Action
from nomad_agents.studies.runs import Row
from nomad_mj.arenas import Geodesic
from nomad_mj.envs import PathFinding
from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray

_PROGRESS = 0.5  # of a move's length


def lattice(scene: Scene, spacing: float, clearance: float = 0.05) -> FloatArray:
    """Return the places (n, 2) of a square lattice [m] where the robot fits and can go on."""
    x0, y0, x1, y1 = scene.free_space.bounds
    xs, ys = (np.arange(low + spacing / 4, high, spacing) for low, high in ((x0, x1), (y0, y1)))
    places = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    fits = scene.plan.clearance(places, scene.robot.layout.radius) > clearance
    return places[fits & shapely.contains_xy(scene.free_space, places)]


def judge_actions(env: PathFinding, actions: Sequence[Action]) -> Row:
    """Return the shares of places where an agent knows what to do, and where that is suitable.

    A move is suitable if it goes clear of everything and comes nearer to the goal, along the
    shortest path, by half its length at least.

    Returns
    -------
    dict
        ``known``: a category acts that matches the situation; ``suitable`` among all places;
        ``known_suitable`` among those where it is known, NaN where there are none.
    """
    scene = env.scene
    radius = scene.robot.layout.radius
    places = np.array([action["place"] for action in actions])
    moves = np.array([action["move"] for action in actions])
    known = np.array([a["kind"] == "reacted" and not a["unmatched"] for a in actions])
    geodesic = Geodesic(scene.plan, scene.arena.goal, radius)
    gained = geodesic.length(places) - geodesic.length(places + moves)
    shares = np.linspace(0.0, 1.0, 11)[:, None, None]
    clear = (scene.plan.clearance(places + shares * moves, radius) > 0).all(axis=0)
    length = np.hypot(moves[:, 0], moves[:, 1])
    suitable = clear & (length > 0) & (gained >= _PROGRESS * length)
    return {
        "known": float(known.mean()),
        "suitable": float(suitable.mean()),
        "known_suitable": float(suitable[known].mean()) if known.any() else float("nan"),
    }
