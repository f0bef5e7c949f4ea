"""Contexts are freed in the right order, closed or not, with another context around."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

SETUP = """
import numpy as np
import nomad_mj
from nomad_mj.video import EpisodeRecorder, snapshot
from nomad_mj.video.studio import Studio
env = nomad_mj.load("path_finding", room="empty_room")
env.reset(seed=1, start=0)
"""
EARLY = """
import weakref
class Kept: pass
kept = Kept()
weakref.finalize(kept, int)  # as importing PyTorch does
"""
SCRIPTS = {
    "closed": """
pixels = env.physics.render(32, 32)
other = Studio(env.scene, "top", (64, 64))
with EpisodeRecorder(env, PATH, size=(160, 120), speed=10.0) as recorder:
    recorder.annotate(np.zeros((21, 21)), np.ones(2), "a move")
    env.step((0.2, 0.0))
try:
    with EpisodeRecorder(env, PATH + ".mp4", size=(160, 120), speed=10.0) as recorder:
        env.reset(seed=1, start=0)
        raise KeyboardInterrupt
except KeyboardInterrupt:
    pass
assert (env.physics.render(32, 32) == pixels).all(), "dm_control draws elsewhere"
first = snapshot(env, "top", (160, 120))
other.show(env.physics.data)
other.begin()
assert other.frame(0.0, 0.0).any()
assert (snapshot(env, "top", (160, 120)) == first).all()
other.close()
other.close()
assert (env.physics.render(32, 32) == pixels).all(), "dm_control draws elsewhere"
env.close()
""",
    "finalizers before OpenGL": """
studio = Studio(env.scene, "side", (320, 120))
studio.show(env.physics.data)
studio.begin()
studio.frame(0.0, 0.0)
""",
    "never closed": """
studio = Studio(env.scene, "side", (320, 120))
studio.show(env.physics.data)
studio.begin()
studio.frame(0.0, 0.0)
recorder = EpisodeRecorder(env, PATH, size=(160, 120))
env.physics.render(32, 32)
""",
}


@pytest.mark.gl
@pytest.mark.parametrize("backend", ["egl", "osmesa"])
@pytest.mark.parametrize("script", SCRIPTS)
def test_nothing_is_printed_at_exit(backend: str, script: str, tmp_path: Path) -> None:
    dropped = ("PYOPENGL_PLATFORM", "DISABLE_RENDER_THREAD_OFFLOADING", "DISPLAY")
    env = {key: value for key, value in os.environ.items() if key not in dropped}
    env |= {"MUJOCO_GL": backend, "PYTHONPATH": os.pathsep.join(sys.path)}
    path = tmp_path / "v.mp4"
    check = f"{SETUP}\nprint(nomad_mj._gl.gl_report().works)"
    early = EARLY if script == "finalizers before OpenGL" else ""
    code = f"{early}\nPATH = {str(path)!r}\n{SETUP}\n{SCRIPTS[script]}\nprint('done')"

    def run(text: str) -> "subprocess.CompletedProcess[str]":
        command = [sys.executable, "-W", "error", "-c", text]
        return subprocess.run(command, env=env, capture_output=True, text=True, check=False)

    done = run(code)
    if done.returncode and run(check).stdout.strip() != "True":
        pytest.skip(f"{backend} does not work here")
    assert (done.returncode, done.stdout, done.stderr) == (0, "done\n", "")
    assert path.exists() == (script == "closed")
    assert len(list(tmp_path.iterdir())) == path.exists()
