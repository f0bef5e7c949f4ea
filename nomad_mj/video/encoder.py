"""Frames become an MP4 file that browsers play; a file that is not finished never shows."""

import contextlib
import os
import secrets
import subprocess
import tempfile
from pathlib import Path

import imageio_ffmpeg

from nomad_mj.errors import ConfigError, OutputError
from nomad_mj.video.canvas import Image
from nomad_mj.video.layout import Size

_QUALITY = ("-preset", "veryfast", "-crf", "20", "-g", "60")


class Encoder:
    """Writes frames beside `path`, and renames the file when it is finished.

    Runs ffmpeg itself: imageio's writer sees neither why it failed nor that it did.

    Parameters
    ----------
    path : str or Path
        The video, ``.mp4``; folders on the way are made.
    size : (int, int)
        Width and height of the frames [px], even.
    fps : float
        Frames a second.

    Raises
    ------
    ConfigError
        The frame rate makes no sense.
    OutputError
        The name is a folder's or not one of an ``.mp4``.
    """

    def __init__(self, path: str | Path, size: Size, fps: float) -> None:
        if not 1 <= fps <= 240:
            raise ConfigError(f"{fps:g} frames a second: must be 1 to 240")
        self.path = Path(path)
        if self.path.suffix.lower() != ".mp4":
            raise OutputError(f"video {str(path)!r}: its name must end in .mp4")
        if self.path.is_dir():
            raise OutputError(f"video {str(path)!r} is a folder: name a file in it")
        # In the same folder, so that renaming it is a single act.
        self._part = self.path.with_name(f".{self.path.stem}-{secrets.token_hex(4)}.mp4")
        self._size, self._fps, self._frames = size, fps, 0
        self._process: subprocess.Popen[bytes] | None = None

    def open(self) -> None:
        """Start the encoder.

        Raises
        ------
        OutputError
            The file cannot be written there.
        """
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._part.touch()
        except OSError as error:
            raise self._cannot(error.strerror) from None
        # A pipe would have to be emptied while ffmpeg runs.
        self._complaints = tempfile.TemporaryFile()  # noqa: SIM115
        try:
            self._process = self._start()
        except BaseException as error:
            self._complaints.close()
            self._part.unlink(missing_ok=True)
            if isinstance(error, OSError | RuntimeError):
                raise self._cannot(f"ffmpeg does not start, {error}") from None
            raise

    def _start(self) -> "subprocess.Popen[bytes]":
        size, rate = "{}x{}".format(*self._size), f"{self._fps:g}"
        taken = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", size, "-r", rate)
        # Without the colour space players guess, and guess differently for small and large videos.
        space = ("-vf", "scale=out_color_matrix=bt709:out_range=tv", "-colorspace", "bt709")
        space += ("-color_primaries", "bt709", "-color_trc", "iec61966-2-1", "-color_range", "tv")
        given = ("-an", "-c:v", "libx264", "-pix_fmt", "yuv420p", *space, *_QUALITY)
        file = ("-movflags", "+faststart", "-f", "mp4", os.fspath(self._part))
        command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-v", "error"]
        return subprocess.Popen(
            [*command, *taken, "-i", "-", *given, *file],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=self._complaints,
            start_new_session=True,  # Ctrl-C is for us to handle
        )

    def _cannot(self, reason: str | None) -> OutputError:
        why = " ".join((reason or "unknown reason").split())
        return OutputError(
            f"video {str(self.path)!r} cannot be written: {why}; choose another place"
        )

    def write(self, frame: Image) -> None:
        """Add a frame; ffmpeg encodes it in a process of its own."""
        assert self._process is not None and self._process.stdin is not None
        try:
            self._process.stdin.write(frame.data)
            self._frames += 1
        except OSError as error:
            raise self._fail(error) from None

    def finish(self) -> None:
        """Complete the file and give it its name."""
        if self._process is None:
            return
        assert self._process.stdin is not None
        if not self._frames:
            self.discard()
            raise OutputError(f"video {str(self.path)!r} would have no frame: nothing was recorded")
        try:
            self._process.stdin.close()
            if self._process.wait() != 0:
                raise OSError(f"ffmpeg ended with {self._process.returncode}")
            self._part.replace(self.path)
        except OSError as error:
            raise self._fail(error) from None
        finally:
            self.discard()

    def _fail(self, error: OSError) -> OutputError:
        """Return the reason that ffmpeg gives for a failure, and clean up."""
        self._stop()
        self._complaints.seek(0)
        lines = self._complaints.read().decode(errors="replace").strip().splitlines()
        self.discard()
        return self._cannot(lines[-1] if lines else error.strerror or str(error))

    def _stop(self) -> None:
        if self._process is None:
            return
        process, self._process = self._process, None
        process.kill()
        process.wait()
        if process.stdin is not None:
            with contextlib.suppress(OSError):  # what it had not taken yet
                process.stdin.close()

    def discard(self) -> None:
        """Stop and leave no unfinished file."""
        self._stop()
        self._complaints.close()
        self._part.unlink(missing_ok=True)
