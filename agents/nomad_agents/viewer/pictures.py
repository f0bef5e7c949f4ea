"""Pictures of a session: the room, the readings, the path, and the certainty grid."""

import io
from types import TracebackType

from PIL import Image as Pillow
from typing_extensions import Self

from nomad_agents.viewer.session import Session
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.video.layout import Size, bare_layout
from nomad_mj.video.palette import BLUE, ORANGE
from nomad_mj.video.studio import Studio

CAMERAS = ("chase", "overview", "top")
_QUALITY = 82


class Pictures:
    """Draws a session through one camera at a time.

    Parameters
    ----------
    session : Session
        What to draw.
    size : (int, int)
        Width and height [px], even.
    camera : str
        One of `CAMERAS` to begin with.

    Attributes
    ----------
    camera : str
        The present one.
    grid : bool
        Whether the certainty grid is shown.

    Raises
    ------
    ConfigError, UnknownNameError
        A size or a camera that there cannot be.
    RenderError
        No OpenGL works here.
    """

    def __init__(self, session: Session, size: Size, camera: str = CAMERAS[0]) -> None:
        self._session, self._size = session, size
        self.camera, self.grid = camera, True
        self._studio = Studio(session.env.scene, bare_layout(camera, size))
        self._episode, self._seen = -1, 0.0

    def follow(self) -> None:
        """Take in the present state; call it after every control step."""
        session, physics = self._session, self._session.env.physics
        self._studio.show(physics.data)
        if session.episodes != self._episode:
            self._episode, self._seen = session.episodes, float(physics.data.time)
            self._studio.begin()
        self._studio.painter.ranges = session.env.motor.task.ranges
        colour = BLUE if session.agent_drives else ORANGE
        trail = self._studio.painter.trail
        if trail is not None and trail.colour != colour:
            trail.stop(colour)
        self._studio.drive()
        self._studio.look_along(physics.pose().heading)

    def next_camera(self) -> None:
        """Change to the next camera; the path so far is kept."""
        self.camera = CAMERAS[(CAMERAS.index(self.camera) + 1) % len(CAMERAS)]
        trail = self._studio.painter.trail
        self._studio.close()
        self._studio = Studio(self._session.env.scene, bare_layout(self.camera, self._size))
        self._episode = -1
        self.follow()
        self._studio.painter.trail = trail

    def jpeg(self) -> bytes:
        """Return the picture of the state that was followed last."""
        session = self._session
        grid = session.percept().grid if self.grid else None
        self._studio.show_grid(grid, session.move, session.cell, BLUE)
        time = float(session.env.physics.data.time)
        elapsed = max(time - self._seen, CONTROL_TIMESTEP)
        self._seen = time
        file = io.BytesIO()
        Pillow.fromarray(self._studio.frame(time, elapsed)).save(file, "JPEG", quality=_QUALITY)
        return file.getvalue()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._studio.close()
