"""Pictures of an environment while it runs, for ``render_mode="rgb_array"``."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from nomad_mj.envs import percept_of
from nomad_mj.perception import SituationSpec
from nomad_mj.scene import Scene
from nomad_mj.tasks import NavigationPhysics
from nomad_mj.types import FloatArray
from nomad_mj.video.canvas import Image
from nomad_mj.video.caption import Caption
from nomad_mj.video.layout import Size, make_layout
from nomad_mj.video.palette import BLUE
from nomad_mj.video.studio import Studio
from nomad_mj.video.trail import Trail


class Camera:
    """Draws the present state, the way driven so far and what is perceived.

    OpenGL is started with the first picture: an environment can be made, copied and sent to other
    processes without it.

    Parameters
    ----------
    scene : Scene
        Robot and room.
    view : str
        "overview", "top", "chase" or "side".
    size : (int, int), optional
        Width and height of the pictures [px], even; that of the view if None.
    situation : SituationSpec, optional
        Of the certainty grid that is shown.

    Raises
    ------
    UnknownNameError, ConfigError
        A view that there is not, a size that a video cannot have.
    """

    def __init__(
        self, scene: Scene, view: str, size: Size | None, situation: SituationSpec | None = None
    ) -> None:
        self._layout = make_layout(view, size)
        self._scene = scene
        self._studio: Studio | None = None
        self._trail: Trail | None = None
        self._situation = situation or SituationSpec()

    def __getstate__(self) -> dict[str, Any]:
        """Return what a copy needs: it starts OpenGL of its own."""
        return {**vars(self), "_studio": None}

    def begin(self, physics: NavigationPhysics) -> None:
        """Forget the way driven: an episode begins."""
        self._trail = Trail(_place(physics))
        self._trail.colour = BLUE
        if self._studio is not None:
            self._studio.show(physics.data)
            self._studio.begin()

    def follow(self, physics: NavigationPhysics) -> None:
        """Let the way reach where the robot is."""
        if self._trail is not None:
            self._trail.extend(_place(physics))

    def picture(
        self,
        physics: NavigationPhysics,
        observation: Mapping[str, FloatArray],
        elapsed: float,
        fields: tuple[tuple[str, str], ...],
    ) -> Image:
        """Return a picture (height, width, 3) of uint8.

        Parameters
        ----------
        physics : NavigationPhysics
            The simulation.
        observation : mapping
            What the sensors read now.
        elapsed : float
            Since the last picture [s of the video].
        fields : tuple of (label, value)
            For the caption.

        Raises
        ------
        RenderError
            No OpenGL works here.
        """
        if self._studio is None:
            self._studio = Studio(self._scene, self._layout)
            self._studio.begin()
        studio, layout = self._studio, self._scene.robot.layout
        studio.show(physics.data)
        studio.painter.trail = self._trail
        studio.painter.ranges = np.concatenate([observation[ring.name] for ring in layout.rings])
        studio.look_along(physics.pose().heading)
        percept = percept_of(observation, layout, self._situation)
        studio.show_grid(percept.grid, None, self._situation.grid.resolution, BLUE)
        studio.caption = Caption(colour=BLUE, fields=fields)
        return studio.frame(float(physics.data.time), elapsed)

    def close(self) -> None:
        """Free the OpenGL context; the next picture makes a new one."""
        if self._studio is not None:
            self._studio.close()
            self._studio = None


def _place(physics: NavigationPhysics) -> FloatArray:
    return np.array(physics.pose()[:2])
