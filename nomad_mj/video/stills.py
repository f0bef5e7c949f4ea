"""Single pictures of an environment."""

import numpy as np

from nomad_mj.envs import PathFinding
from nomad_mj.video.canvas import Image
from nomad_mj.video.layout import Size
from nomad_mj.video.studio import Studio


def snapshot(env: PathFinding, view: str = "overview", size: Size | None = None) -> Image:
    """Return a picture of an environment as it is now, readings (without noise) included.

    Parameters
    ----------
    env : PathFinding
        What to draw.
    view : str
        "chase", "top", "overview" or "side".
    size : (int, int), optional
        Width and height [px], even; that of the view if None.

    Returns
    -------
    array (height, width, 3) of uint8

    Raises
    ------
    UnknownNameError, ConfigError
        A view that there is not, a size that is odd, too small or too large.
    RenderError
        No OpenGL works here.
    """
    rays = env.scene.robot.rays
    with Studio(env.scene, view, size) as studio:
        studio.show(env.physics.data)
        studio.begin()
        studio.painter.ranges = np.clip(env.physics.cone_ranges(), rays.minimum, rays.maximum)
        return studio.frame(0.0, 0.0)
