"""Movers in pictures: drawn where they are, and gliding in between."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nomad_mj
from nomad_mj.video import EpisodeRecorder, snapshot
from nomad_mj.video.layout import make_layout
from nomad_mj.video.studio import Studio

pytestmark = pytest.mark.gl

SMALL = (160, 120)
LARGE = (480, 480)


@pytest.fixture
def env() -> Iterator[nomad_mj.PathFinding]:
    env = nomad_mj.load(room="moving_room", task_kwargs={"random": 0})
    env.reset(start=4)
    yield env
    env.close()


def test_movers_glide_between_control_steps(
    env: nomad_mj.PathFinding, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[list[float]] = []
    known: list[list[float]] = []

    def frame(studio: Studio, time: float, elapsed: float, title: Any = None) -> np.ndarray:
        drawn.append([time, *studio.data.mocap_pos.ravel().tolist()])
        return np.zeros((SMALL[1], SMALL[0], 3), dtype=np.uint8)

    def places(_: Any = None) -> None:
        movers = env.motor.task.movers
        assert movers is not None
        x, y = np.concatenate([movers.obstacles, movers.goal[None]]).T
        height = env.physics.data.mocap_pos[:, 2]
        known.append([env.physics.time(), *np.column_stack([x, y, height]).ravel().tolist()])

    monkeypatch.setattr(Studio, "frame", frame)
    places()
    env.on_control_step = places
    with EpisodeRecorder(env, tmp_path / "v.mp4", size=SMALL) as recorder:
        recorder.annotate()
        env.step((0.5, 0.0))
    seen, true = np.array(drawn), np.array(known)
    assert len(seen) > 20 and np.ptp(seen[:, 1:], axis=0).max() > 0.1
    for column in range(1, seen.shape[1]):
        expected = np.interp(seen[:, 0], true[:, 0], true[:, column])
        np.testing.assert_allclose(seen[:, column], expected, atol=1e-9)


def plum(picture: np.ndarray) -> np.ndarray:
    """Return where the picture has the colour of moving obstacles."""
    red, green, blue = np.moveaxis(picture.astype(int), -1, 0)
    return (blue - green > 25) & (red - green > 5)


def teal(picture: np.ndarray) -> np.ndarray:
    """Return where it has that of the goal."""
    red, green, blue = np.moveaxis(picture.astype(int), -1, 0)
    return (green - red > 60) & (green - blue > 15)


def test_a_picture_shows_them_where_they_are(env: nomad_mj.PathFinding) -> None:
    left, top, width, height = make_layout("top", LARGE).panes[0].box
    pixel = 10.7 / height  # [m]
    middle = np.array([left + width / 2 - 0.5, top + height / 2 - 0.5])
    for _ in range(3):
        picture = snapshot(env, "top", LARGE)
        movers = env.motor.task.movers
        assert movers is not None
        row, column = np.nonzero(plum(picture))
        seen = 5 + (np.stack([column, row], axis=-1) - middle) * (pixel, -pixel)
        off = np.hypot(*(seen[:, None] - movers.obstacles).T)
        assert (off.min(axis=0) < 0.3).mean() > 0.98
        assert all((off.argmin(axis=0) == i).sum() > 200 for i in range(4))
        row, column = np.nonzero(teal(picture))
        seen = 5 + (np.stack([column, row], axis=-1) - middle) * (pixel, -pixel)
        np.testing.assert_allclose(seen.mean(axis=0), movers.goal, atol=0.05)
        env.step((1.0, 0.0))


def test_an_episode_that_differs_in_its_movers_only_begins_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[np.ndarray] = []

    def frame(studio: Studio, time: float, elapsed: float, title: Any = None) -> np.ndarray:
        drawn.append(studio.data.mocap_pos.copy())
        return np.zeros((SMALL[1], SMALL[0], 3), dtype=np.uint8)

    monkeypatch.setattr(Studio, "frame", frame)
    options = {"moving_obstacles": nomad_mj.MovingObstacles()}
    with (
        nomad_mj.load(task_kwargs=options) as env,
        EpisodeRecorder(env, tmp_path / "v.mp4", size=SMALL) as recorder,
    ):
        for seed in (0, 1):
            env.reset(seed=seed, start=4)
            recorder.hold(0.1)
            np.testing.assert_array_equal(drawn[-1], env.physics.data.mocap_pos)
    assert (drawn[0] != drawn[-1]).any()
