"""Choosing an OpenGL backend, before mujoco or dm_control is imported.

Both packages read ``MUJOCO_GL`` once, at import: unset, mujoco binds GLFW whether or not there is a
display, and set to a backend that does not work here it makes ``import dm_control.mujoco`` fail.
So the backends are tried first.
"""

from __future__ import annotations

import functools
import importlib
import os
import sys
from typing import NamedTuple

from nomad_mj._gl_probe import problem_with
from nomad_mj.errors import RenderError

# dm_control takes these words for each backend, and no others (dm_control/_render/constants.py).
_WORDS = {
    "egl": ("egl",),
    "osmesa": ("osmesa",),
    "glfw": ("glfw", "on", "enable", "enabled", "true", "1"),
    "off": ("off", "disable", "disabled", "false", "0"),
}
# Holds what MUJOCO_GL held before it was set to "off" for want of a backend that works.
_FOUND_NONE = "NOMAD_MJ_FOUND_NO_GL"
# libegl1 alone lacks the software driver, and the library PyOpenGL asks for errors.
_INSTALL = {
    "egl": "sudo apt-get install -y libegl1 libopengl0 libgl1-mesa-dri",
    "osmesa": "sudo apt-get install -y libosmesa6",
}


class Attempt(NamedTuple):
    """One backend that was tried; `problem` is None where it works."""

    backend: str
    problem: str | None


class GLReport(NamedTuple):
    """The backend in use ("egl", "osmesa", "glfw" or "off") and how it was found.

    `asked` is what ``MUJOCO_GL`` held before, None if it was unset or empty.
    """

    backend: str
    asked: str | None
    attempts: tuple[Attempt, ...]

    @property
    def works(self) -> bool:
        """Whether pictures can be drawn."""
        return self.backend != "off"

    @property
    def message(self) -> str:
        """One line: the backend in use, or why there is none and what to install."""
        if self.works:
            return f"OpenGL: {self.backend}"
        if not self.attempts:
            return f"pictures are switched off by MUJOCO_GL={self.asked!r}; unset it to draw"
        tried = "; ".join(f"{name}: {problem}" for name, problem in self.attempts)
        if self.asked is None:
            hint = f"on Debian or Ubuntu type: {_INSTALL['egl']}"
        elif self.attempts[0].backend in _INSTALL:
            hint = f"on Debian or Ubuntu type: {_INSTALL[self.attempts[0].backend]}"
        else:
            hint = "unset MUJOCO_GL"
        asked = f" with MUJOCO_GL={self.asked!r}" if self.asked else ""
        return f"no OpenGL works here{asked} ({tried}); {hint}"


def choose_backend() -> str:
    """Choose the OpenGL backend, once, and set ``MUJOCO_GL`` and ``PYOPENGL_PLATFORM`` to it.

    A ``MUJOCO_GL`` already set is the only backend tried. Otherwise GLFW comes first where there
    is a local display, since dm_control's viewer works with no other, then EGL, then OSMesa.

    Returns
    -------
    str
        "egl", "osmesa", "glfw", or "off" where none works: mujoco and dm_control then import and
        simulate, and only pictures are missing.
    """
    return gl_report().backend


def require_gl() -> None:
    """Check that pictures can be drawn.

    Raises
    ------
    nomad_mj.errors.RenderError
        Where no backend works; the message names what was tried and what to install.
    """
    report = gl_report()
    if not report.works:
        raise RenderError(report.message)


@functools.cache
def gl_report() -> GLReport:
    """Choose the backend, once, and say what was tried.

    Returns
    -------
    GLReport
        Its `message` is one line for a person.
    """
    asked = os.environ.get("MUJOCO_GL", "").strip() or None
    if asked == "off" and _FOUND_NONE in os.environ:
        # That "off" is ours, from a parent process: search again, to say what was tried.
        asked = os.environ[_FOUND_NONE] or None
    bound = sys.modules.get("dm_control._render")
    report = _adopt(asked, getattr(bound, "BACKEND", None)) if bound else _search(asked)
    _bind(report)
    return report


def _adopt(asked: str | None, bound: str | None) -> GLReport:
    """Keep the backend of a dm_control that was imported before us: it cannot be changed."""
    if bound == "off":
        return GLReport(bound, asked or bound, ())
    if bound is not None:
        return GLReport(bound, asked, (Attempt(bound, None),))
    why = "imported before nomad_mj, it found none; import nomad_mj first"
    return GLReport("off", asked, (Attempt("dm_control", why),))


def _search(asked: str | None) -> GLReport:
    """Try the backends in order until one works."""
    attempts: list[Attempt] = []
    for backend in _order(asked):
        attempts.append(Attempt(backend, problem_with(backend)))
        if attempts[-1].problem is None:
            return GLReport(backend, asked, tuple(attempts))
    return GLReport("off", asked, tuple(attempts))


def _order(asked: str | None) -> tuple[str, ...]:
    """Name the backends to try, in order."""
    if asked is not None:
        word = asked.lower()
        named = [backend for backend, words in _WORDS.items() if word in words]
        return tuple(name for name in named or [asked] if name != "off")
    # A display forwarded over the network (host:0) draws slowly, or too old an OpenGL.
    local = os.environ.get("DISPLAY", "").startswith((":", "unix:", "/"))
    if local or os.environ.get("WAYLAND_DISPLAY") or sys.platform != "linux":
        return ("glfw", "egl", "osmesa")
    return ("egl", "osmesa", "glfw")


def _bind(report: GLReport) -> None:
    """Tell mujoco, dm_control and PyOpenGL, in this process and its children."""
    os.environ["MUJOCO_GL"] = report.backend
    if report.attempts and not report.works:
        os.environ[_FOUND_NONE] = report.asked or ""
    if report.backend in ("egl", "osmesa"):
        os.environ["PYOPENGL_PLATFORM"] = report.backend
    if report.backend == "osmesa":
        # dm_control's render thread is gone before its contexts are freed at exit, which it then
        # says on standard error; EGL and GLFW have no such thread.
        os.environ.setdefault("DISABLE_RENDER_THREAD_OFFLOADING", "1")
    # A mujoco imported before us has bound GLFW if MUJOCO_GL was unset.
    bound = sys.modules.get("mujoco.rendering.classic.gl_context")
    if bound is not None and report.asked is None and report.works:
        importlib.reload(bound)
        sys.modules["mujoco"].GLContext = bound.GLContext  # type: ignore[attr-defined]
