"""Real pictures of real drives, small and few."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import nomad_mj
from nomad_mj.errors import ConfigError, OutputError, UnknownNameError
from nomad_mj.video import BLUE, GREY, ORANGE, VIEWS, Caption, EpisodeRecorder, snapshot
from nomad_mj.video.palette import GREEN, RGB
from nomad_mj.video.studio import Studio

pytestmark = pytest.mark.gl

Decode = Callable[[Path, tuple[int, int]], Any]
SMALL = (160, 120)
START = (2.0, 2.0, 0.0)
AHEAD = np.array([0.2, 0.0])


@pytest.fixture
def env() -> Iterator[nomad_mj.PathFinding]:
    env = nomad_mj.load("path_finding", room="paper_room")
    env.reset(seed=1, start=START)
    yield env
    env.close()


def near(pixels: np.ndarray, colour: RGB, tolerance: int = 40) -> np.ndarray:
    off = np.abs(pixels.astype(int) - 255 * np.array(colour))
    return off.max(axis=-1) < tolerance


def files(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir()]


def drive(recorder: EpisodeRecorder, env: nomad_mj.PathFinding, colour: RGB = BLUE) -> None:
    recorder.annotate(np.zeros((21, 21)), np.array([0.2, 0.0]), Caption("reacted", colour))
    env.step(AHEAD)


@pytest.mark.parametrize("speed", [1.5, 6.0])
def test_the_video_is_as_long_as_the_drive(
    env: nomad_mj.PathFinding, tmp_path: Path, decode: Decode, speed: float
) -> None:
    path = tmp_path / "v.mp4"
    with EpisodeRecorder(env, path, size=SMALL, speed=speed) as recorder:
        recorder.start_episode("paper room", pause=0.5)
        drive(recorder, env)
        recorder.hold(0.2)
        assert not path.exists()
    expected = round(0.5 * 30) + env.physics.time() / speed * 30 + round(0.2 * 30)
    assert recorder.frames == pytest.approx(expected, abs=1.01)
    frames, _ = decode(path, SMALL)
    assert len(frames) == recorder.frames
    assert files(tmp_path) == ["v.mp4"]
    assert env.on_control_step is None
    assert (frames[0] != frames[20]).mean() > 0.05  # the title has gone
    assert near(frames[-1], BLUE).sum() > 10


def test_the_robot_moves_evenly_between_control_steps(
    env: nomad_mj.PathFinding, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[tuple[float, ...]] = []
    known = [(0.0, *env.physics.pose())]

    def frame(studio: Studio, time: float, elapsed: float, title: Any = None) -> np.ndarray:
        drawn.append((time, *studio.place))
        return np.zeros((SMALL[1], SMALL[0], 3), dtype=np.uint8)

    monkeypatch.setattr(Studio, "frame", frame)
    env.on_control_step = lambda: known.append((env.physics.time(), *env.physics.pose()))
    hook = env.on_control_step
    with EpisodeRecorder(env, tmp_path / "v.mp4", size=SMALL) as recorder:
        drive(recorder, env)
    assert env.on_control_step is hook
    seen, true = np.array(drawn), np.array(known)
    np.testing.assert_allclose(np.diff(seen[:, 0]), 1 / 30)
    assert seen[-1, 0] == pytest.approx(true[-1, 0], abs=1 / 30)
    for column in (1, 2):
        expected = np.interp(seen[:, 0], true[:, 0], true[:, column])
        np.testing.assert_allclose(seen[:, column], expected, atol=1e-9)
    assert np.ptp(seen[:, 1]) > 0.05


def test_recording_changes_nothing(env: nomad_mj.PathFinding, tmp_path: Path) -> None:
    def reading() -> np.ndarray:
        return env.step(AHEAD).observation["sonar"]

    plain = reading()
    env.reset(seed=1, start=START)
    with EpisodeRecorder(env, tmp_path / "v.mp4", size=SMALL, speed=5.0) as recorder:
        recorder.start_episode()
        np.testing.assert_array_equal(reading(), plain)


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_an_interrupted_recording_leaves_nothing(
    env: nomad_mj.PathFinding, tmp_path: Path, error: type[BaseException]
) -> None:
    (tmp_path / "v.mp4").write_bytes(b"the video of yesterday")
    with (
        pytest.raises(error),
        EpisodeRecorder(env, tmp_path / "v.mp4", size=SMALL, speed=10.0) as recorder,
    ):
        drive(recorder, env)
        raise error
    assert env.on_control_step is None
    assert files(tmp_path) == ["v.mp4"]
    assert (tmp_path / "v.mp4").read_bytes() == b"the video of yesterday"


def test_several_episodes_share_a_video(
    env: nomad_mj.PathFinding, tmp_path: Path, decode: Decode
) -> None:
    path, size = tmp_path / "v.mp4", (640, 480)
    with EpisodeRecorder(env, path, view="top", size=size, speed=10.0) as recorder:
        for number, colour in enumerate((BLUE, ORANGE)):
            env.reset(seed=number, start=(2.0 + 3 * number, 2.0, 0.0))
            recorder.start_episode(f"start {number}", pause=0.1)
            recorder.annotate(caption=Caption("", colour))
            env.step((0.8, 0.0))
            recorder.hold(0.1)
    floor = decode(path, size).frames[:, 300:].astype(int)  # where nothing else has a colour
    warm = floor[..., 0] - floor[..., 2]
    blue = (warm[:, :, 170:360] < -65).sum(axis=(1, 2))
    orange = (warm[:, :, 360:470] > 115).sum(axis=(1, 2))
    assert blue.max() > 20 and orange[0] == 0
    assert blue[-1] == 0 and orange[-1] > 20  # the path of the first episode has gone


def test_an_episode_that_nobody_announced_is_noticed(
    env: nomad_mj.PathFinding, tmp_path: Path
) -> None:
    with EpisodeRecorder(env, tmp_path / "v.mp4", size=SMALL, speed=10.0) as recorder:
        env.step(AHEAD)
        env.reset(seed=2, start=(7.0, 5.0, 0.0))
        recorder.hold(0.1)
        np.testing.assert_allclose(
            recorder._studio.place,  # pyright: ignore[reportPrivateUsage]
            (7.0, 5.0),
            atol=1e-9,
        )
        env.step(AHEAD)


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"view": "below"}, UnknownNameError, "unknown view 'below'"),
        ({"size": (161, 120)}, ConfigError, "161 x 120: its width must be an even number"),
        ({"speed": 0.0}, ConfigError, "speed 0: must be 0.01 to 1000"),
        ({"fps": 0.0}, ConfigError, "0 frames a second"),
        ({"path": "v.gif"}, OutputError, "must end in .mp4"),
    ],
)
def test_bad_options_are_refused(
    env: nomad_mj.PathFinding, tmp_path: Path, options: dict[str, Any], error: Any, message: str
) -> None:
    path = tmp_path / options.pop("path", "v.mp4")
    with pytest.raises(error, match=message):
        EpisodeRecorder(env, path, **options)
    assert files(tmp_path) == []


def test_a_place_that_cannot_be_written_is_an_output_error(
    env: nomad_mj.PathFinding, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    with (
        pytest.raises(OutputError, match="cannot be written"),
        EpisodeRecorder(env, tmp_path / "file" / "v.mp4", size=SMALL),
    ):
        pass
    assert env.on_control_step is None


@pytest.mark.parametrize("view", VIEWS)
def test_snapshots_show_robot_and_goal(env: nomad_mj.PathFinding, view: str) -> None:
    env.reset(seed=1, start=(6.6, 7.9, 0.0))
    frame = snapshot(env, view, (320, 240))
    assert frame.shape == (240, 320, 3) and frame.dtype == np.uint8 and frame.flags.c_contiguous
    red, green, blue = np.moveaxis(frame.astype(int), -1, 0)
    assert ((green > red + 40) & (green > blue + 20)).sum() > 8  # the goal
    assert (frame.max(axis=-1) < 70).sum() > 20  # the robot


def test_frames_show_path_readings_move_and_inset(env: nomad_mj.PathFinding) -> None:
    with Studio(env.scene, "top", (640, 480)) as studio:
        studio.show(env.physics.data)
        studio.begin()
        bare = studio.frame(0.0, 0.0)
        room = (slice(None), slice(160, None))

        painter = studio.painter
        painter.ranges = np.full(env.scene.robot.layout.count, 1.0)
        painter.ranges[0] = 6.5  # a miss
        readings = studio.frame(0.0, 0.0)[room]
        drawn = np.argwhere((np.abs(readings.astype(int) - bare[room]) > 25).any(axis=-1))
        middle = np.array([480 - 15.45 - 44.86 * 2, 15.45 + 44.86 * 2])
        off = drawn - middle
        reach = np.hypot(*off.T)
        assert 44.86 * 1.2 < reach.max() < 44.86 * 1.35  # 1 m from the perimeter
        directions = np.unique(np.round(np.arctan2(-off[:, 0], off[:, 1])[reach > 40] * 8 / np.pi))
        assert set(directions % 16) == set(range(1, 16))  # all but the miss, straight to the east

        painter.ranges = None
        studio.show_move(np.eye(21), np.array([0.0, 1.0]), 0.2, Caption("planned", ORANGE))
        trail = painter.trail
        assert trail is not None
        trail.extend(studio.place + np.array([-1.0, 0.0]))
        trail.extend(studio.place)
        frame = studio.frame(0.0, 0.0)
        orange = np.argwhere(near(frame[room], ORANGE, 45)) - middle
        assert orange[:, 0].min() < -40  # the move, one metre to the north
        assert orange[:, 1].min() < -40  # the path, one metre to the west
        assert orange[:, 0].max() < 10 and orange[:, 1].max() < 10
        assert near(frame[:175, :160], (0.20, 0.30, 0.46), 20).sum() > 21 * 15  # the inset


def test_decorations_beyond_what_a_scene_holds_are_left_out(env: nomad_mj.PathFinding) -> None:
    with Studio(env.scene, "top", (64, 64)) as studio:
        studio.show(env.physics.data)
        studio.begin()
        trail = studio.painter.trail
        assert trail is not None
        for place in np.random.default_rng(0).uniform(0, 10, (600, 2)):
            trail.stop(GREY)
            trail.extend(place)
        assert near(studio.frame(0.0, 0.0), GREY, 60).any()


def test_the_goal_is_seen_over_walls(env: nomad_mj.PathFinding) -> None:
    env.reset(seed=1, start=(8.4, 1.5, 0.0))  # behind a box, seen from the goal
    frame = snapshot(env, "chase", (320, 240))
    assert near(frame, GREEN, 50).any()
