"""Record episodes as a video: the simulation runs as it would, the recorder looks on."""

from pathlib import Path
from types import TracebackType
from typing import NamedTuple

import mujoco
import numpy as np
import numpy.typing as npt
from typing_extensions import Self

from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError
from nomad_mj.types import FloatArray
from nomad_mj.video.canvas import Image
from nomad_mj.video.caption import Caption
from nomad_mj.video.encoder import Encoder
from nomad_mj.video.layout import Size
from nomad_mj.video.studio import Studio
from nomad_mj.video.title import title_card

_EPS = 1e-9  # [s]


class _State(NamedTuple):
    time: float
    qpos: FloatArray
    mocap_pos: FloatArray
    ranges: FloatArray


class EpisodeRecorder:
    """Writes an MP4 of what happens in an environment while the ``with`` block runs.

    The file appears when the block ends; if it ends with an exception, Ctrl-C included, there is
    none.

    Parameters
    ----------
    env : PathFinding
        What to look at. Its `on_control_step` is borrowed; one that was set still gets called.
    path : str or Path
        The video, ``.mp4``.
    view : str
        "chase", "top", "overview" or "side".
    size : (int, int), optional
        Width and height [px], even; that of the view if None.
    fps : float
        Frames a second of the video.
    speed : float
        Simulated seconds in a second of the video.

    Attributes
    ----------
    frames : int
        Frames written so far.

    Raises
    ------
    UnknownNameError, ConfigError
        An option that makes no sense.
    OutputError
        The file cannot be written.
    RenderError
        No OpenGL works here.
    """

    def __init__(
        self,
        env: PathFinding,
        path: str | Path,
        *,
        view: str = "chase",
        size: Size | None = None,
        fps: float = 30.0,
        speed: float = 1.0,
    ) -> None:
        if not 0.01 <= speed <= 1000:
            raise ConfigError(f"speed {speed:g}: must be 0.01 to 1000 times real time")
        self._env = env
        self._fps, self._speed = fps, speed
        self._studio = Studio(env.scene, view, size, speed)
        try:
            self._encoder = Encoder(path, self._studio.layout.size, fps)
        except BaseException:
            self._studio.close()
            raise
        self._before: _State | None = None
        self._origin, self._since = 0.0, 0
        self._change = np.zeros(env.scene.model.nv)
        self.frames = 0

    def __enter__(self) -> Self:
        try:
            self._encoder.open()
        except BaseException:
            self._studio.close()
            raise
        self._borrowed = self._env.on_control_step
        self._env.on_control_step = self._on_control_step
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._env.on_control_step = self._borrowed
        self._studio.close()
        if kind is None:
            self._encoder.finish()
        else:
            self._encoder.discard()

    def start_episode(self, title: str = "", subtitle: str = "", pause: float = 1.2) -> None:
        """Look at a new episode; call it after the environment's reset.

        Parameters
        ----------
        title, subtitle : str
            Shown over the first picture, if not empty.
        pause : float
            For how long [s of the video].
        """
        self._begin(self._see())
        if title:
            self.hold(pause, title, subtitle)

    def hold(self, seconds: float, title: str = "", subtitle: str = "") -> None:
        """Stand still for some seconds of the video, with a title if there is one."""
        before = self._catch_up()
        layout = self._studio.layout
        card = title_card(title, subtitle, layout.panes[0].box, layout.unit) if title else None
        frame = self._studio.frame(before.time, 0.0, card)
        for _ in range(round(seconds * self._fps)):
            self._write(frame)

    def annotate(
        self,
        grid: FloatArray | None = None,
        move: FloatArray | None = None,
        caption: Caption | str = "",
        *,
        cell: float = 0.2,
    ) -> None:
        """Say what is decided now; shown until the next call.

        Parameters
        ----------
        grid : array (N, N), optional
            Certainty grid for the inset; rows along y, oriented as the world, the robot in the
            middle.
        move : array (2,), optional
            Chosen displacement [m], oriented as the world.
        caption : Caption or str
            The line of text; its colour is that of the move and of the path from here on.
        cell : float
            Side of a cell of the grid [m].
        """
        if isinstance(caption, str):
            caption = Caption(fields=(("", caption),) if caption else ())
        self._catch_up()
        self._studio.show_move(grid, move, cell, caption)

    def caption(self, caption: Caption) -> None:
        """Change the caption only: what became of the decision."""
        self._studio.caption = caption

    def _see(self, ranges: FloatArray | None = None) -> _State:
        physics = self._env.physics
        if ranges is None:
            rays = self._env.scene.robot.rays
            ranges = np.clip(physics.cone_ranges(), rays.minimum, rays.maximum)
        data = physics.data
        return _State(float(data.time), data.qpos.copy(), data.mocap_pos.copy(), ranges)

    def _catch_up(self) -> _State:
        """Begin an episode if the simulation is not where it was seen last; return its state."""
        state, before = self._see(), self._before
        if before is None or before.time != state.time:
            return self._begin(state)
        same = np.array_equal(before.qpos, state.qpos)
        same &= np.array_equal(before.mocap_pos, state.mocap_pos)
        return before if same else self._begin(state)

    def _begin(self, state: _State) -> _State:
        self._before = state
        self._origin, self._since = state.time, 0
        self._studio.show(self._env.physics.data)
        self._studio.begin()
        self._studio.painter.ranges = state.ranges
        return state

    def _on_control_step(self) -> None:
        if self._borrowed is not None:
            self._borrowed()
        state = self._see(self._env.motor.task.ranges.copy())
        if self._before is None or state.time <= self._before.time:
            self._begin(state)
            return
        self._film(self._before, state)
        self._before = state
        self._studio.show(self._env.physics.data)
        self._studio.drive()

    def _film(self, before: _State, after: _State) -> None:
        """Write the frames after one control step up to the next."""
        model = self._env.scene.model
        mujoco.mj_differentiatePos(model, self._change, 1.0, before.qpos, after.qpos)
        step = self._speed / self._fps
        while (time := self._origin + self._since * step) <= after.time + _EPS:
            self._since += 1
            share = (time - before.time) / (after.time - before.time)
            qpos = before.qpos.copy()
            mujoco.mj_integratePos(model, qpos, self._change, share)
            mocap_pos = (1 - share) * before.mocap_pos + share * after.mocap_pos
            self._studio.show(self._env.physics.data, qpos, mocap_pos)
            # Readings glide too: their noise, anew at each step, would make the rays flicker.
            mixed = (1 - share) * before.ranges + share * after.ranges
            self._studio.painter.ranges = np.where(self._hit(before, after), mixed, after.ranges)
            self._write(self._studio.frame(time, 1 / self._fps))

    def _hit(self, *states: _State) -> npt.NDArray[np.bool_]:
        """Whether a cone, (C,), has met something in all of the states."""
        limit = self._env.scene.robot.rays.maximum
        return np.logical_and.reduce([state.ranges < limit for state in states])

    def _write(self, frame: Image) -> None:
        self._encoder.write(frame)
        self.frames += 1
