"""Gymnasium's wrappers, and pictures."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium
import imageio_ffmpeg
import numpy as np
import pytest
from gymnasium import wrappers

from nomad_mj.gym import PathFindingEnv
from nomad_mj.gym.registration import MOTOR, PATH_FINDING

STRAIGHT = np.array([1.0, 0.0], dtype=np.float32)


def make(**options: Any) -> "gymnasium.Env[Any, Any]":
    return gymnasium.make(PATH_FINDING, room="empty_room", robot="khepera", **options)


def drive(env: "gymnasium.Env[Any, Any]") -> dict[str, Any]:
    """Go straight until the episode is over; return the last info."""
    env.reset(seed=0, options={"start": 0})
    info, over, truncated = dict[str, Any](), False, False
    while not over:
        observed, _, terminated, truncated, info = env.step(STRAIGHT)
        assert observed in env.observation_space
        over = terminated or truncated
    return info | {"truncated": truncated}


def test_wrappers_work_together() -> None:
    env: Any = wrappers.FlattenObservation(make(observation="dict"))
    env = wrappers.NormalizeObservation(wrappers.RecordEpisodeStatistics(env))
    env = wrappers.TimeAwareObservation(env)
    info = drive(env)
    assert info["is_success"] and not info["truncated"]
    assert info["episode"]["l"] > 1 and info["episode"]["r"] <= 0
    env.close()


def test_the_time_limit_of_make_counts_steps() -> None:
    env = make(max_episode_steps=2)
    assert drive(env)["truncated"]
    env.close()


def test_a_vector_of_environments_fills_info() -> None:
    envs = gymnasium.make_vec(PATH_FINDING, 2, "sync", room="empty_room", robot="khepera")
    envs.reset(seed=0)
    *_, info = envs.step(np.array([STRAIGHT, STRAIGHT]))
    assert info["cost"].tolist() == [0.0, 0.0] and info["pose"].shape == (2, 3)
    envs.close()


@pytest.mark.gl
@pytest.mark.parametrize("name", [PATH_FINDING, MOTOR])
def test_record_video_writes_what_happens(name: str, tmp_path: Path) -> None:
    pytest.importorskip("moviepy")
    env: Any = gymnasium.make(
        name, room="paper_room", robot="nomad200", render_mode="rgb_array", max_episode_steps=4
    )
    env = wrappers.RecordVideo(env, str(tmp_path / "videos"), disable_logger=True)
    env.reset(seed=0, options={"start": 3})
    for _ in range(4):
        env.step(env.action_space.sample())
    fps = env.metadata["render_fps"]
    env.close()
    (path,) = tmp_path.glob("videos/*.mp4")
    assert imageio_ffmpeg.count_frames_and_secs(str(path)) == (5, pytest.approx(5 / fps, abs=0.1))
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "rawvideo"]
    command += ["-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    frames = np.frombuffer(raw, np.uint8).reshape(5, 480, 800, 3).astype(int)
    assert np.abs(frames[0] - frames[-1]).max() > 50  # the robot, its rays, the step's number


@pytest.mark.gl
def test_pictures_leave_the_episode_as_it_is() -> None:
    plain, seen = make(), make(render_mode="rgb_array", view="top", width=96, height=96)
    for env in (plain, seen):
        env.reset(seed=2)
    for _ in range(3):
        picture: Any = seen.render()
        assert picture.shape == (96, 96, 3) and picture.dtype == np.uint8
        one, other = plain.step(STRAIGHT), seen.step(STRAIGHT)
        assert np.array_equal(one[0], other[0]) and one[1] == other[1]
    plain.close()
    seen.close()


def test_without_a_render_mode_nothing_is_drawn() -> None:
    env = PathFindingEnv("empty_room", "khepera")
    with pytest.warns(UserWarning, match="no render_mode was given"):
        assert env.render() is None
    env.close()


def test_without_opengl_only_drawing_fails_in_one_line() -> None:
    code = """
import gymnasium, nomad_mj.gym
from nomad_mj.errors import RenderError
env = gymnasium.make("nomad_mj/PathFinding-v0", robot="khepera", render_mode="rgb_array")
env.reset(seed=0)
env.step(env.action_space.sample())
try:
    env.render()
except RenderError as error:
    print(error)
env.close()
"""
    ran = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        env={**os.environ, "MUJOCO_GL": "off"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.stderr == ""
    assert ran.stdout == "pictures are switched off by MUJOCO_GL='off'; unset it to draw\n"
