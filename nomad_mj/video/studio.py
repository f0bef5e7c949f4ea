"""Whole frames: the room with everything drawn into it, and the cards over it."""

import math
from types import TracebackType
from typing import Any

import mujoco
import numpy as np
from typing_extensions import Self

from nomad_mj.arenas import goal_site
from nomad_mj.geometry import direction
from nomad_mj.scene import Scene
from nomad_mj.types import FloatArray
from nomad_mj.video.cameras import ChaseCamera, fixed_camera
from nomad_mj.video.canvas import Canvas, Image
from nomad_mj.video.caption import Caption, CaptionBar
from nomad_mj.video.cards import Card
from nomad_mj.video.inset import inset_card
from nomad_mj.video.layout import Layout, Size, make_layout
from nomad_mj.video.painter import Painter
from nomad_mj.video.palette import RGB
from nomad_mj.video.trail import Trail

_AIMLESS = 0.1  # [m]


class Studio:
    """Draws frames of a scene. It has a state of its own: the simulation is never touched.

    Parameters
    ----------
    scene : Scene
        Robot and room.
    view : str or Layout
        One of `layout.VIEWS`, or where everything lies.
    size : (int, int), optional
        Width and height of the frames [px], even; that of the view if None.
    speed : float
        Said beside the time, unless it is 1.

    Attributes
    ----------
    data : mujoco.MjData
        The state drawn next; `show` sets it.
    painter : Painter
        What is drawn into the room.
    caption : Caption or None
        The caption under the picture; None for none.

    Raises
    ------
    UnknownNameError, ConfigError
        A view that there is not, a size that a video cannot have.
    RenderError
        No OpenGL works here.
    """

    def __init__(
        self,
        scene: Scene,
        view: str | Layout = "chase",
        size: Size | None = None,
        speed: float = 1.0,
    ) -> None:
        self.layout = make_layout(view, size) if isinstance(view, str) else view
        self._scene = scene
        self._canvas = Canvas(scene.model, self.layout)
        self.data = mujoco.MjData(scene.model)
        self.painter = Painter(scene, self.layout.unit)
        self.caption: Caption | None = None
        self._bar = CaptionBar(self.layout.caption, self.layout.unit, speed)
        self._inset: Card | None = None
        self._base = scene.robot.footing.base
        self._goal = goal_site(scene.model)
        self._chase = ChaseCamera(scene)
        self._course = math.nan
        self._drive: FloatArray = np.zeros(2)
        self._cameras = {"chase": self._chase.camera}
        self._cameras |= {name: fixed_camera(scene, name) for name in ("top", "overview")}

    def show(
        self, seen: Any, qpos: FloatArray | None = None, mocap_pos: FloatArray | None = None
    ) -> None:
        """Take over a simulation's positions; `qpos`, `mocap_pos` if given stand for its own."""
        self.data.qpos[:] = seen.qpos if qpos is None else qpos
        self.data.mocap_pos[:] = seen.mocap_pos if mocap_pos is None else mocap_pos
        self.data.mocap_quat[:] = seen.mocap_quat
        mujoco.mj_kinematics(self._scene.model, self.data)
        mujoco.mj_comPos(self._scene.model, self.data)
        mujoco.mj_camlight(self._scene.model, self.data)

    def camera(self, name: str) -> mujoco.MjvCamera:
        """Return the camera "chase", "top" or "overview" as it is now."""
        return self._cameras[name]

    @property
    def place(self) -> FloatArray:
        """Where the robot is drawn, (2,) [m]."""
        return self.data.xpos[self._base][:2].copy()

    def begin(self) -> None:
        """Forget the path and look at the robot where it is: an episode begins."""
        self.painter.trail = Trail(self.place)
        self.painter.move = self.painter.ranges = self.caption = self._inset = None
        self._course = math.nan
        self._drive = np.zeros(2)

    def drive(self) -> None:
        """Let the path reach the robot's place."""
        if self.painter.trail is not None:
            self.painter.trail.extend(self.place)

    def look_along(self, course: float) -> None:
        """Let the chase camera follow a course [rad], at once if there was none."""
        if math.isnan(self._course):
            self._chase.cut(self.data, course)
        self._course = course

    def show_move(
        self, grid: FloatArray | None, move: FloatArray | None, cell: float, caption: Caption
    ) -> None:
        """Show a decision at the present place: see `EpisodeRecorder.annotate`."""
        colour = caption.colour
        self.caption = caption
        if self.painter.trail is not None:
            self.painter.trail.stop(colour)
        self.painter.move = None
        if move is not None:
            place = self.place
            self.painter.move = place, place + move, colour
            # Moves of the past weigh in: the camera shall not swing with every short one.
            self._drive = 0.5 * self._drive + move
            if np.hypot(*self._drive) > _AIMLESS:
                self.look_along(float(direction(self._drive)))
        self.show_grid(grid, move, cell, colour)

    def show_grid(
        self, grid: FloatArray | None, move: FloatArray | None, cell: float, colour: RGB
    ) -> None:
        """Show a certainty grid in the inset, None for no inset, with a move of that colour."""
        self._inset = None
        if grid is not None:
            self._inset = inset_card(
                grid,
                move,
                cell=cell,
                radius=self._scene.robot.layout.radius,
                colour=colour,
                place=self.layout.inset,
                unit=self.layout.unit,
            )

    def frame(self, time: float, elapsed: float, title: Card | None = None) -> Image:
        """Return a frame of the present state.

        Parameters
        ----------
        time : float
            Simulated time [s], for the caption.
        elapsed : float
            Since the last frame [s of the video], for the chase camera.
        title : Card, optional
            Laid over everything.
        """
        if math.isnan(self._course):
            self.look_along(float(direction(self.data.site_xpos[self._goal][:2] - self.place)))
        self._chase.follow(self.data, self._course, elapsed)
        frame = self._canvas.draw(
            self.data,
            self._cameras,
            lambda marks, pane: self.painter.decorate(self.data, marks, pane),
        )
        if self._inset is not None:
            self._inset.lay_over(frame)
        if self.caption is not None:
            self._bar.lay_over(frame, self.caption, time)
        if title is not None:
            title.lay_over(frame)
        return frame

    def close(self) -> None:
        """Free the OpenGL context; more than once does no harm."""
        self._canvas.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
