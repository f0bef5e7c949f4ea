"""Read videos back. imageio's readers leave their pipes open, which is an error here."""

import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import imageio_ffmpeg
import numpy as np
import pytest


class Video(NamedTuple):
    """Frames (N, height, width, 3) and what ffmpeg says of the stream."""

    frames: np.ndarray
    stream: str


@pytest.fixture
def decode() -> Callable[[Path, tuple[int, int]], Video]:
    """Return a function of a video's path and size."""

    def read(path: Path, size: tuple[int, int]) -> Video:
        command = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "rawvideo"]
        command += ["-pix_fmt", "rgb24", "-fps_mode", "passthrough", "-"]
        done = subprocess.run(command, capture_output=True, check=True)
        frames = np.frombuffer(done.stdout, dtype=np.uint8).reshape(-1, size[1], size[0], 3)
        lines = done.stderr.decode().splitlines()
        return Video(frames, next(line for line in lines if "Video: h264" in line))

    return read
