import os
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nomad_mj.errors import ConfigError, OutputError
from nomad_mj.video.encoder import Encoder

Decode = Callable[[Path, tuple[int, int]], Any]
SIZE = (64, 96)


def files(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir()]


def flat(colour: tuple[int, int, int]) -> np.ndarray:
    return np.full((SIZE[1], SIZE[0], 3), colour, dtype=np.uint8)


def test_frames_come_back_as_they_went_in(tmp_path: Path, decode: Decode) -> None:
    path = tmp_path / "new" / "folder" / "v.mp4"
    encoder = Encoder(path, SIZE, 30.0)
    encoder.open()
    colours = [(200, 60, 40), (40, 90, 210), (240, 240, 235)]
    for colour in colours:
        for _ in range(5):
            encoder.write(flat(colour))
    assert not path.exists()
    encoder.finish()
    assert files(path.parent) == ["v.mp4"]
    frames, stream = decode(path, SIZE)
    assert len(frames) == 15
    for i, colour in enumerate(colours):
        assert np.abs(frames[5 * i + 2].reshape(-1, 3).mean(axis=0) - colour).max() < 6
    assert "yuv420p" in stream and "bt709" in stream and "30 fps" in stream
    data = path.read_bytes()
    assert data.index(b"moov") < data.index(b"mdat")  # a browser can begin before it has it all


def test_an_old_video_stays_until_the_new_one_is_finished(tmp_path: Path) -> None:
    path = tmp_path / "v.mp4"
    path.write_bytes(b"old")
    for finish in (False, True):
        encoder = Encoder(path, SIZE, 30.0)
        encoder.open()
        encoder.write(flat((0, 0, 0)))
        assert path.read_bytes() == b"old"
        if finish:
            encoder.finish()
        else:
            encoder.discard()
    assert path.read_bytes() != b"old"
    assert files(tmp_path) == ["v.mp4"]


def test_a_finished_video_can_be_read_by_others(tmp_path: Path) -> None:
    mask = os.umask(0o022)
    try:
        encoder = Encoder(tmp_path / "v.mp4", SIZE, 30.0)
        encoder.open()
        encoder.write(flat((0, 0, 0)))
        encoder.finish()
    finally:
        os.umask(mask)
    assert (tmp_path / "v.mp4").stat().st_mode & 0o777 == 0o644


def test_an_encoder_that_dies_is_an_output_error(tmp_path: Path) -> None:
    encoder = Encoder(tmp_path / "v.mp4", SIZE, 30.0)
    encoder.open()
    process = encoder._process  # pyright: ignore[reportPrivateUsage]
    assert process is not None
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    with pytest.raises(OutputError, match=r"'.*v\.mp4' cannot be written: .*"):
        for _ in range(50):
            encoder.write(flat((0, 0, 0)))
        encoder.finish()
    encoder.discard()
    assert files(tmp_path) == []


def test_a_video_without_frames_is_an_output_error(tmp_path: Path) -> None:
    encoder = Encoder(tmp_path / "v.mp4", SIZE, 30.0)
    encoder.open()
    with pytest.raises(OutputError, match="no frame"):
        encoder.finish()
    assert files(tmp_path) == []


@pytest.mark.parametrize(
    ("name", "message"),
    [("v.avi", r"must end in \.mp4"), ("", "must end"), ("folder.mp4", "is a folder")],
)
def test_a_name_that_is_no_video_is_refused(tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "folder.mp4").mkdir()
    with pytest.raises(OutputError, match=message):
        Encoder(tmp_path / name, SIZE, 30.0)


def test_a_folder_that_cannot_be_made_is_an_output_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    encoder = Encoder(tmp_path / "file" / "v.mp4", SIZE, 30.0)
    with pytest.raises(OutputError, match=r"cannot be written: (Not a directory|File exists)"):
        encoder.open()


@pytest.mark.parametrize("fps", [0.0, -1.0, 1000.0, float("nan")])
def test_a_frame_rate_that_makes_no_sense_is_refused(tmp_path: Path, fps: float) -> None:
    with pytest.raises(ConfigError, match="must be 1 to 240"):
        Encoder(tmp_path / "v.mp4", SIZE, fps)
