"""Trying an OpenGL backend for real, in the way mujoco and dm_control will use it.

Standard library only and nothing imported from this package, so that the set-up script can run this
file before anything is installed. No GL library is needed to import it.
"""

from __future__ import annotations

import ctypes
import os
import sys
import warnings
from typing import Any, NoReturn


class _UnusableError(Exception):
    """Why a backend does not work here."""


def problem_with(backend: str) -> str | None:
    """Make and drop a context.

    Parameters
    ----------
    backend
        "egl", "osmesa" or "glfw".

    Returns
    -------
    str or None
        Why `backend` does not work here; None where it does.
    """
    probes = {"egl": _probe_egl, "osmesa": _probe_osmesa, "glfw": _probe_glfw}
    try:
        if backend not in probes:
            _fail("no such backend; there are egl, osmesa, glfw and off")
        if backend != "glfw":
            _check_pyopengl(backend)
        probes[backend]()
    except (_UnusableError, OSError) as problem:
        return str(problem)
    return None


def _fail(problem: str) -> NoReturn:
    raise _UnusableError(problem)


def _check_pyopengl(backend: str) -> None:
    """Check that PyOpenGL, through which EGL and OSMesa are reached, is free for `backend`."""
    wanted = os.environ.get("PYOPENGL_PLATFORM")
    if wanted not in (None, "", backend):
        _fail(f"PYOPENGL_PLATFORM={wanted!r} asks for another; unset it")
    loaded = type(getattr(sys.modules.get("OpenGL.platform"), "PLATFORM", None)).__name__
    if loaded.lower() not in ("nonetype", f"{backend}platform"):
        _fail(f"PyOpenGL was imported before nomad_mj, with its {loaded}")


def _function(library: ctypes.CDLL, name: str, result: Any, *arguments: Any) -> Any:
    """Get a function of EGL, which hands out its extensions by name at run time only."""
    find = library.eglGetProcAddress
    find.restype, find.argtypes = ctypes.c_void_p, [ctypes.c_char_p]
    address = find(name.encode())
    if not address:
        _fail(f"{name} is missing")
    return ctypes.CFUNCTYPE(result, *arguments)(address)


def _probe_egl() -> None:
    """Make an OpenGL context on the first EGL device that will, as mujoco.egl does."""
    # Mesa writes about every device it may not open to standard error, at import.
    os.environ.setdefault("EGL_LOG_LEVEL", "fatal")
    egl = ctypes.CDLL("libEGL.so.1")
    _check_opengl_library()
    pointer, integer = ctypes.c_void_p, ctypes.c_int
    query = _function(egl, "eglQueryDevicesEXT", integer, integer, pointer, pointer)
    display_of = _function(egl, "eglGetPlatformDisplayEXT", pointer, integer, pointer, pointer)
    initialise = _function(egl, "eglInitialize", integer, pointer, pointer, pointer)
    devices, count = (pointer * 10)(), integer()
    if not query(len(devices), devices, ctypes.byref(count)) or not count.value:
        _fail("there is no EGL device")
    for device in _egl_candidates(list(devices[: count.value])):
        display = display_of(0x313F, device, None)  # EGL_PLATFORM_DEVICE_EXT
        if display and initialise(display, None, None):
            return _try_egl_context(egl, display)
    _fail("no EGL device can be initialised")


def _check_opengl_library() -> None:
    """Check for the library PyOpenGL asks for errors after every call; libegl1 brings none."""
    problems: list[OSError] = []
    for name in ("libOpenGL.so.0", "libGL.so.1", "libGLESv2.so.2"):
        try:
            ctypes.CDLL(name)
        except OSError as problem:  # noqa: PERF203
            problems.append(problem)
        else:
            return
    raise problems[0]


def _egl_candidates(devices: list[int | None]) -> list[int | None]:
    chosen = os.environ.get("MUJOCO_EGL_DEVICE_ID")
    if chosen is None:
        return devices
    if not chosen.isdecimal() or int(chosen) >= len(devices):
        _fail(f"MUJOCO_EGL_DEVICE_ID={chosen!r} is not in 0..{len(devices) - 1}")
    return [devices[int(chosen)]]


def _try_egl_context(egl: ctypes.CDLL, display: int) -> None:
    """Make and drop a context of desktop OpenGL; the display stays initialised for the user."""
    pointer, integer = ctypes.c_void_p, ctypes.c_int
    choose = _function(egl, "eglChooseConfig", integer, pointer, pointer, pointer, integer, pointer)
    bind = _function(egl, "eglBindAPI", integer, integer)
    create = _function(egl, "eglCreateContext", pointer, pointer, pointer, pointer, pointer)
    destroy = _function(egl, "eglDestroyContext", integer, pointer, pointer)
    config, count = pointer(), integer()
    # Depth of 24 bits, a pbuffer surface, desktop OpenGL, end of list.
    attributes = (integer * 7)(0x3025, 24, 0x3033, 1, 0x3040, 8, 0x3038)
    choose(display, attributes, ctypes.byref(config), 1, ctypes.byref(count))
    context = bind(0x30A2) and count.value and create(display, config, None, None)
    if not context:
        _fail("EGL makes no desktop OpenGL context")
    destroy(display, context)


def _probe_osmesa() -> None:
    """Make and drop an OSMesa context, as mujoco.osmesa does."""
    osmesa = ctypes.CDLL("libOSMesa.so.8")
    create, destroy = osmesa.OSMesaCreateContextExt, osmesa.OSMesaDestroyContext
    create.restype, create.argtypes = ctypes.c_void_p, [ctypes.c_int] * 4 + [ctypes.c_void_p]
    destroy.argtypes = [ctypes.c_void_p]
    context = create(0x1908, 24, 8, 0, None)  # GL_RGBA, bits of depth, stencil, accumulation
    if not context:
        _fail("OSMesa makes no context")
    destroy(context)


def _probe_glfw() -> None:
    """Make and drop a hidden window."""
    displays = (os.environ.get("DISPLAY"), os.environ.get("WAYLAND_DISPLAY"))
    if sys.platform == "linux" and not any(displays):
        _fail("there is no display")
    # GLFW reports its errors as warnings; kept, they tell why, and nothing is printed.
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            import glfw
        except ImportError as error:
            _fail(str(error))
        window = None
        if glfw.init():
            glfw.window_hint(glfw.VISIBLE, 0)
            window = glfw.create_window(1, 1, "nomad_mj", None, None)
            glfw.default_window_hints()
        if not window:
            _fail(str(caught[-1].message) if caught else "no window can be made")
        glfw.destroy_window(window)
