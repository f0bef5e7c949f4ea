"""Each case runs in a process of its own: a backend is chosen once in the life of a process."""

import os
import subprocess
import sys
from collections.abc import Mapping

import pytest

from nomad_mj import _gl
from nomad_mj._gl import Attempt, GLReport
from nomad_mj.errors import RenderError

CHOSEN = (
    "MUJOCO_GL",
    "PYOPENGL_PLATFORM",
    "DISPLAY",
    "WAYLAND_DISPLAY",
    "MUJOCO_EGL_DEVICE_ID",
    "DISABLE_RENDER_THREAD_OFFLOADING",
    "NOMAD_MJ_FOUND_NO_GL",
)
CHOOSE = "from nomad_mj._gl import *; print(choose_backend()); print(gl_report().message)\n"
MODEL = """
XML = "<mujoco><worldbody><light pos='0 0 3'/><geom size='.1' rgba='1 0 0 1'/></worldbody></mujoco>"
"""
DRAW_MUJOCO = """
model = mujoco.MjModel.from_xml_string(XML)
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
renderer = mujoco.Renderer(model, 32, 32)
renderer.update_scene(data)
assert renderer.render().any()
"""
DRAW_DM_CONTROL = """
from dm_control.mujoco import Physics
physics = Physics.from_xml_string(XML)
assert physics.render(32, 32).any()
"""


def run(script: str, env: Mapping[str, str] | None = None) -> list[str]:
    """Run `script` as a user would and return its lines; what it says on stderr is an error."""
    clean = {key: value for key, value in os.environ.items() if key not in CHOSEN}
    clean.update({"PYTHONPATH": os.pathsep.join(sys.path), **(env or {})})
    command = [sys.executable, "-W", "error", "-c", script]
    done = subprocess.run(command, env=clean, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout.splitlines()


@pytest.fixture(scope="module", params=["egl", "osmesa"])
def backend(request: pytest.FixtureRequest) -> str:
    """Each backend that needs no display, where it works."""
    name: str = request.param
    chosen, message = run(CHOOSE, {"MUJOCO_GL": name})
    if chosen == "off":
        pytest.skip(message)
    return name


def test_a_backend_is_chosen_and_announced() -> None:
    script = CHOOSE + "import os; print(os.environ['MUJOCO_GL'])"
    chosen, message, announced = run(script)
    if chosen == "off":
        pytest.skip(message)
    assert chosen in {"egl", "osmesa"}  # there is no display here
    assert announced == chosen
    assert message == f"OpenGL: {chosen}"


def test_a_backend_asked_for_is_the_one_used(backend: str) -> None:
    assert run(CHOOSE, {"MUJOCO_GL": backend})[0] == backend
    assert run(CHOOSE, {"MUJOCO_GL": f" {backend.upper()} "})[0] == backend


@pytest.mark.parametrize(
    ("env", "says"),
    [
        ({"MUJOCO_GL": "off"}, ["switched off by MUJOCO_GL='off'", "unset it"]),
        ({"MUJOCO_GL": "glfw"}, ["no display", "unset MUJOCO_GL"]),
        ({"MUJOCO_GL": "vulkan"}, ["no such backend", "egl, osmesa, glfw", "unset MUJOCO_GL"]),
        (
            {"MUJOCO_GL": "egl", "PYOPENGL_PLATFORM": "glx"},
            ["PYOPENGL_PLATFORM='glx'", "libegl1"],
        ),
    ],
)
def test_without_opengl_all_but_pictures_works(env: dict[str, str], says: list[str]) -> None:
    script = CHOOSE + MODEL
    script += "from dm_control.mujoco import Physics\nPhysics.from_xml_string(XML).step()"
    chosen, message = run(script, env)
    assert chosen == "off"
    for part in says:
        assert part in message


@pytest.mark.parametrize("draw", [DRAW_DM_CONTROL, DRAW_DM_CONTROL + "physics.free()"])
def test_dm_control_draws_and_exits_in_silence(backend: str, draw: str) -> None:
    run(CHOOSE + MODEL + draw, {"MUJOCO_GL": backend})


def test_mujoco_and_dm_control_draw_in_one_process(backend: str) -> None:
    script = CHOOSE + MODEL + "import mujoco" + DRAW_MUJOCO + DRAW_DM_CONTROL
    run(script + "renderer.close(); physics.free()", {"MUJOCO_GL": backend})


def test_a_mujoco_imported_first_draws_too(backend: str) -> None:
    # Left to choose, it finds EGL or OSMesa; the fixture says that one of them works.
    run("import mujoco\n" + CHOOSE + MODEL + DRAW_MUJOCO + "renderer.close()")


@pytest.mark.gl
def test_the_backend_of_a_dm_control_imported_first_is_kept() -> None:
    chosen, _, bound = run(
        "from dm_control import _render\n" + CHOOSE + "print(_render.BACKEND)",
        {"MUJOCO_GL": _gl.choose_backend()},
    )
    assert chosen == bound


def test_a_child_process_says_what_its_parent_tried() -> None:
    child = "import subprocess, sys; subprocess.run([sys.executable, '-c', sys.argv[1]])"
    script = f"import sys; sys.argv.append({CHOOSE!r})\n{CHOOSE}sys.stdout.flush()\n{child}"
    lines = run(script, {"MUJOCO_GL": "glfw"})
    assert lines[:2] == lines[2:]
    assert "no display" in lines[3]


def test_the_message_names_every_backend_tried_and_what_to_install() -> None:
    attempts = (Attempt("egl", "no libEGL"), Attempt("osmesa", "no libOSMesa"))
    message = GLReport("off", None, attempts).message
    assert "\n" not in message
    for part in ("egl: no libEGL", "osmesa: no libOSMesa", "apt-get install -y libegl1"):
        assert part in message


def test_a_picture_asked_for_without_opengl_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    report = GLReport("off", None, (Attempt("egl", "no libEGL"),))
    monkeypatch.setattr(_gl, "gl_report", lambda: report)
    with pytest.raises(RenderError, match="no libEGL"):
        _gl.require_gl()


@pytest.mark.gl
def test_a_picture_asked_for_with_opengl_is_not_refused() -> None:
    _gl.require_gl()
