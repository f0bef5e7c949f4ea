"""An OpenGL picture of several panes, read back as an array."""

import atexit
import threading
import weakref
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
from dm_control._render import base

from nomad_mj._gl import require_gl
from nomad_mj.errors import RenderError
from nomad_mj.video.layout import Layout, Pane
from nomad_mj.video.marks import Marks
from nomad_mj.video.palette import GROUND

Image = npt.NDArray[np.uint8]
"""Rows from the top, (height, width, 3)."""

_MOST_GEOMS = 10_000
_WIDEST = 4.0  # width by height of a pane


def scene_option() -> mujoco.MjvOption:
    """Return what to show of a model: not mujoco's rays, which bury the robot."""
    option = mujoco.MjvOption()
    option.flags[mujoco.mjtVisFlag.mjVIS_RANGEFINDER] = 0
    return option


def sees_sky(scene: mujoco.MjvScene) -> bool:
    """Whether the scene's camera looks above the horizon: drawing a sky takes a fifth of a frame.

    The floor has no end.
    """
    eye = scene.camera[0]
    forward, up = np.array(eye.forward, dtype=float), np.array(eye.up, dtype=float)
    top = float(eye.frustum_top)
    if eye.orthographic:
        return bool(forward[2] > -0.5)
    aside = max(float(eye.frustum_width), top * _WIDEST) * abs(float(np.cross(forward, up)[2]))
    highest = forward[2] + (top * abs(up[2]) + aside) / float(eye.frustum_near)
    return bool(highest > -0.03)


def _take_turns() -> None:
    """Let dm_control make its own context current again when it next draws in this thread.

    It remembers which of its contexts was current last and trusts that nobody else draws.
    """
    thread = threading.current_thread()
    context = getattr(base, "_CURRENT_CONTEXT_FOR_THREAD", {}).pop(thread, None)
    getattr(base, "_CURRENT_THREAD_FOR_CONTEXT", {}).pop(context, None)


def _free(gl: Any, context: Any) -> None:
    # The OpenGL objects of a context that is not current would be some other context's.
    gl.make_current()
    context.free()
    gl.free()
    _take_turns()


class Canvas:
    """Draws a model into the panes of a layout; `mujoco.Renderer` knows one pane only.

    Parameters
    ----------
    model : mujoco.MjModel
        What to draw.
    layout : Layout
        Where.

    Raises
    ------
    RenderError
        No OpenGL works here, or not at this size.
    """

    def __init__(self, model: mujoco.MjModel, layout: Layout) -> None:
        require_gl()
        self._model = model
        self._panes = layout.panes
        width, height = layout.size
        area = sum(pane.box.width * pane.box.height for pane in layout.panes)
        self._covered = area == width * height
        self._option = scene_option()
        self._scene = mujoco.MjvScene(model, _MOST_GEOMS)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 0
        self._marks = Marks(self._scene)
        self._pixels: Image = np.zeros((height, width, 3), dtype=np.uint8)
        try:
            gl = mujoco.GLContext(width, height)
            gl.make_current()
            context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100.value)
            # As large as the picture, not as the model's largest: clearing it costs time.
            mujoco.mjr_resizeOffscreen(width, height, context)
            mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, context)
        except (RuntimeError, ImportError, mujoco.FatalError) as error:
            reason = " ".join(str(error).split())
            raise RenderError(f"OpenGL cannot draw {width} x {height} pixels: {reason}") from None
        self._gl, self._context = gl, context
        self.close = weakref.finalize(self, _free, gl, context)
        _close_at_exit(self.close)

    def draw(
        self,
        data: mujoco.MjData,
        cameras: dict[str, mujoco.MjvCamera],
        decorate: Callable[[Marks, Pane], None],
    ) -> Image:
        """Return the picture of a state, every pane from its camera.

        Parameters
        ----------
        data : mujoco.MjData
            The state, its positions computed.
        cameras : dict
            A camera for each name that the panes use.
        decorate : callable
            Adds marks to a pane.
        """
        self._gl.make_current()
        height, width, _ = self._pixels.shape
        whole = mujoco.MjrRect(0, 0, width, height)
        if not self._covered:
            mujoco.mjr_rectangle(whole, *GROUND, 1.0)
        for pane in self._panes:
            x, y, pane_width, pane_height = pane.box
            mujoco.mjv_updateScene(
                self._model,
                data,
                self._option,
                None,
                cameras[pane.camera],
                mujoco.mjtCatBit.mjCAT_ALL.value,
                self._scene,
            )
            self._scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = sees_sky(self._scene)
            decorate(self._marks, pane)
            rect = mujoco.MjrRect(x, height - y - pane_height, pane_width, pane_height)
            mujoco.mjr_render(rect, self._scene, self._context)
        mujoco.mjr_readPixels(self._pixels, None, whole, self._context)
        _take_turns()
        return np.ascontiguousarray(self._pixels[::-1])


_open: list["weakref.finalize[..., Any]"] = []


def _close_at_exit(close: "weakref.finalize[..., Any]") -> None:
    """Free a canvas that nobody closes while OpenGL is still there.

    What is registered last runs first at exit. A finalizer's own hook may be older than OpenGL's.
    """
    close.atexit = False
    if not _open:
        atexit.register(_close_all)
    _open[:] = [*(each for each in _open if each.alive), close]


def _close_all() -> None:
    for close in _open:
        close()
