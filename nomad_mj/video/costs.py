"""What a recorded frame costs, against the same picture from `mujoco.Renderer` alone."""

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import mujoco
import numpy as np

from nomad_mj.envs import PathFinding
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.video.canvas import scene_option, sees_sky
from nomad_mj.video.caption import Caption
from nomad_mj.video.encoder import Encoder
from nomad_mj.video.layout import Size
from nomad_mj.video.palette import BLUE, ORANGE
from nomad_mj.video.studio import Studio

_BLOCK = 8  # frames of one kind in a row: the encoder lags behind by one or two
_STOPS = 15


class FrameCosts(NamedTuple):
    """Lower quartiles over blocks of frames [us]: the machine's other work only ever adds."""

    recorded_us: float
    bare_us: float

    @property
    def ratio(self) -> float:
        """How much more a recorded frame costs."""
        return self.recorded_us / self.bare_us


class _Episode:
    """Plays an episode as a recording shows it, on and on: a zigzag, a decision a second."""

    def __init__(self, env: PathFinding, studio: Studio, encoder: Encoder) -> None:
        self._studio, self._encoder = studio, encoder
        self._random = np.random.default_rng(0)
        self._data = env.physics.data
        self._rays = env.scene.robot.rays
        self._frame = 0
        studio.show(self._data)
        studio.begin()
        for _ in range(_STOPS):
            self._decide()
            self._wander()

    def _wander(self) -> None:
        trail = self._studio.painter.trail
        assert trail is not None
        trail.extend(self._studio.place + self._random.uniform(-2.0, 2.0, 2))

    def _decide(self) -> None:
        caption = Caption("planned", ORANGE if self._frame % 2 else BLUE, (("decision", "12"),))
        grid, move = self._random.random((21, 21)), self._random.uniform(-1, 1, 2)
        self._studio.show_move(grid, move, 0.2, caption)

    def play(self) -> None:
        """Record the next frame."""
        self._frame += 1
        if self._frame % 30 == 0:
            self._decide()
        painter = self._studio.painter
        painter.ranges = np.minimum(3.0 * self._random.random(len(self._rays.first)), 6.0)
        self._studio.show(self._data)
        self._encoder.write(self._studio.frame(CONTROL_TIMESTEP * self._frame, 1 / 30))


def _timed(draw: Callable[[], object]) -> float:
    """Return what a frame of a block takes, on average [s]."""
    began = time.perf_counter()
    for _ in range(_BLOCK):
        draw()
    return (time.perf_counter() - began) / _BLOCK


def frame_costs(
    env: PathFinding, frames: int = 80, view: str = "chase", size: Size = (640, 480)
) -> FrameCosts:
    """Measure both kinds of frames, in turns.

    Parameters
    ----------
    env : PathFinding
        Drawn as it is; not changed.
    frames : int
        Of each kind.
    view : str
        "chase", whose only pane is the whole picture.
    size : (int, int)
        Of the frames [px].

    Raises
    ------
    NomadError
        As of `EpisodeRecorder`.
    """
    option, sky = scene_option(), mujoco.mjtRndFlag.mjRND_SKYBOX
    width, height = size
    with tempfile.TemporaryDirectory() as folder, Studio(env.scene, view, size) as studio:
        encoder = Encoder(Path(folder) / "costs.mp4", size, 30.0)
        encoder.open()
        renderer = mujoco.Renderer(env.scene.model, height, width)
        try:
            episode = _Episode(env, studio, encoder)
            camera = studio.camera(view)

            def draw_bare() -> None:
                renderer.update_scene(studio.data, camera, option)
                renderer.scene.flags[sky] = sees_sky(renderer.scene)
                renderer.render()

            count = 1 + max(frames // _BLOCK, 1)  # the first warms up
            blocks = [(_timed(episode.play), _timed(draw_bare)) for _ in range(count)]
        finally:
            renderer.close()
            encoder.discard()
    recorded_us, bare_us = 1e6 * np.quantile(blocks[1:], 0.25, axis=0)
    return FrameCosts(float(recorded_us), float(bare_us))
