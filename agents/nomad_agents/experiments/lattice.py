"""Places all over a room, at which an agent is asked what it does."""

import numpy as np
import shapely

from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray


def lattice(scene: Scene, spacing: float, clearance: float = 0.05) -> FloatArray:
    """Return the places (n, 2) of a square lattice [m] where the robot fits and can go on."""
    x0, y0, x1, y1 = scene.free_space.bounds
    xs, ys = (np.arange(low + spacing / 4, high, spacing) for low, high in ((x0, x1), (y0, y1)))
    places = np.stack(np.meshgrid(xs, ys), axis=-1).reshape(-1, 2)
    fits = scene.plan.clearance(places, scene.robot.layout.radius) > clearance
    return places[fits & shapely.contains_xy(scene.free_space, places)]
