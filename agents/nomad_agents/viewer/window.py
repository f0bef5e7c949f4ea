"""View a session in MuJoCo's own window, where there is a screen.

The window tells when a key goes down, not how long it is held: each tap of a key drives for
`teleoperation.PATIENCE` seconds. Letters and space are its own shortcuts, so other keys drive.
"""

import math
import os
import threading
import time
from contextlib import suppress
from typing import Any

import mujoco

from nomad_agents.viewer.controls import LOOKING, Controls
from nomad_agents.viewer.pace import Pace
from nomad_agents.viewer.session import ClosedError, Session
from nomad_agents.viewer.teleoperation import KEYS
from nomad_mj._gl import gl_report
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.video.layout import Box, Pane
from nomad_mj.video.marks import Marks
from nomad_mj.video.painter import Painter
from nomad_mj.video.trail import Trail

# By the numbers that GLFW gives them.
_HELD = {
    265: "forward",
    264: "back",
    263: "left",
    262: "right",
    44: "aside_left",
    46: "aside_right",
}
_ASKED = {257: "stop", 268: "reset", 269: "agent"}
_HELP = (
    ("arrow keys", "drive, a tap each"),
    (", .", "go sideways, if the robot can"),
    ("Enter", "stop"),
    ("Home", "start again"),
    ("End", "agent on, off"),
)
_PANE = Pane("chase", Box(0, 0, 640, 480))


def has_screen() -> bool:
    """Return whether a window can be opened: OpenGL works on this machine's display."""
    display = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    return bool(display) and gl_report().backend == "glfw"


def take_key(controls: Controls, key: int) -> None:
    """Take in a key of the window's by its GLFW number; any other is the window's own."""
    if key in _HELD:
        controls.hold(KEYS[_HELD[key]])
    elif key in _ASKED:
        controls.ask(_ASKED[key])


class _Window:
    """Shows a session in a viewer; the simulation itself is never touched from there."""

    def __init__(self, session: Session, handle: Any, data: mujoco.MjData, until: float) -> None:
        self._session, self._handle, self._data = session, handle, data
        self._painter = Painter(session.env.scene, 1.0)
        self._marks = Marks(handle.user_scn)
        self._pace = Pace(CONTROL_TIMESTEP)
        self._episode, self._until = -1, until

    def __call__(self) -> None:
        if not self._handle.is_running() or time.monotonic() >= self._until:
            raise ClosedError
        session, painter = self._session, self._painter
        session.controls.take(LOOKING)
        with self._handle.lock():
            show(session, self._data)
            place = self._data.xpos[session.env.scene.robot.footing.base][:2].copy()
            if session.episodes != self._episode or painter.trail is None:
                self._episode, painter.trail = session.episodes, Trail(place)
            painter.trail.extend(place)
            painter.ranges = session.env.motor.task.ranges
            self._handle.user_scn.ngeom = 0
            painter.decorate(self._data, self._marks, _PANE)
        self._handle.set_texts([_text(_HELP, top=False), _text(_lines(session), top=True)])
        self._handle.sync()
        self._pace.wait()


def show(session: Session, data: mujoco.MjData) -> None:
    """Copy what a picture needs of the simulation to `data`."""
    seen, model = session.env.physics.data, session.env.scene.model
    data.time = seen.time
    data.qpos[:] = seen.qpos
    data.mocap_pos[:] = seen.mocap_pos
    data.mocap_quat[:] = seen.mocap_quat
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_camlight(model, data)


def _lines(session: Session) -> tuple[tuple[str, str], ...]:
    task, physics = session.env.motor.task, session.env.physics
    pose = physics.pose()
    return (
        ("driver", session.driver),
        ("speed", f"{session.speed:.2f} m/s"),
        ("place", f"{pose.x:.2f}, {pose.y:.2f} m"),
        ("nearest", f"{float(task.ranges.min()):.2f} m"),
        ("goal", f"{task.goal_distance(physics):.2f} m"),
        ("", session.news),
    )


def _text(lines: tuple[tuple[str, str], ...], *, top: bool) -> tuple[Any, Any, str, str]:
    grid = mujoco.mjtGridPos
    place = grid.mjGRID_TOPLEFT if top else grid.mjGRID_BOTTOMLEFT
    return None, place, "\n".join(a for a, _ in lines), "\n".join(b for _, b in lines)


def view_in_window(session: Session, *, launch: Any = None, seconds: float | None = None) -> None:
    """Show a session in a window until it is closed.

    Parameters
    ----------
    session : Session
        What to show and drive.
    launch : callable, optional
        In place of `mujoco.viewer.launch_passive`.
    seconds : float, optional
        Close it by itself after so long.
    """
    if launch is None:
        from mujoco import viewer  # needs GLFW, which a machine without a screen may lack

        launch = viewer.launch_passive
    scene = session.env.scene
    data = mujoco.MjData(scene.model)
    show(session, data)

    def on_key(key: int) -> None:
        take_key(session.controls, key)

    others = set(threading.enumerate())
    until = float("inf") if seconds is None else time.monotonic() + seconds
    handle = launch(
        scene.model,
        data,
        key_callback=on_key,
        show_left_ui=False,
        show_right_ui=False,
    )
    try:
        with handle.lock():
            handle.cam.type = mujoco.mjtCamera.mjCAMERA_TRACKING
            handle.cam.trackbodyid = scene.robot.footing.base
            handle.cam.distance, handle.cam.elevation = 4.5, -35.0
            handle.cam.azimuth = math.degrees(session.env.physics.pose().heading)
            handle.opt.flags[mujoco.mjtVisFlag.mjVIS_RANGEFINDER] = 0
        window = _Window(session, handle, data, until)
        with suppress(ClosedError), session.shown_by(window):
            while True:
                session.advance()
    finally:
        handle.close()
        # Python must not end before the window's own thread has let go of the model.
        for thread in set(threading.enumerate()) - others:
            thread.join(10.0)
