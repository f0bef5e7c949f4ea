"""Files as part of a page: data URIs, and how large pictures are shown."""

import base64
from pathlib import Path
from typing import NamedTuple

from PIL import Image, UnidentifiedImageError

from nomad_mj.errors import OutputError

_TYPES = {
    ".png": "image/png",
    ".jpg": "image/jpeg",
    ".jpeg": "image/jpeg",
    ".svg": "image/svg+xml",
    ".mp4": "video/mp4",
}
_SHOWN_DPI = 96  # a pixel of a web page is 1/96 inch
_WIDE = 1.5  # width by height from which a picture takes the whole width


class Picture(NamedTuple):
    """A picture within a page.

    Attributes
    ----------
    uri : str
        The whole file.
    width, height : int or None
        At which to show it at most [px]; None where the file does not say.
    """

    uri: str
    width: int | None
    height: int | None

    @property
    def wide(self) -> bool:
        """Whether it is much wider than high."""
        return bool(self.width and self.height and self.width > _WIDE * self.height)


def data_uri(path: Path) -> str:
    """Return a file as a data URI.

    Raises
    ------
    OutputError
        It cannot be read, or is of a kind that pages do not show.
    """
    suffix = path.suffix.lower()
    if suffix not in _TYPES:
        raise OutputError(f"{str(path)!r} cannot be shown: must be one of {', '.join(_TYPES)}")
    try:
        data = path.read_bytes()
    except OSError as error:
        raise _unreadable(path, error.strerror or str(error)) from None
    return f"data:{_TYPES[suffix]};base64,{base64.b64encode(data).decode()}"


def picture(path: Path) -> Picture:
    """Return a picture, to be shown as large as it says (PNG) or pixel by pixel.

    Raises
    ------
    OutputError
        It cannot be read, or is no picture.
    """
    path = path.with_suffix(".png") if path.suffix.lower() == ".pdf" else path
    uri = data_uri(path)
    if path.suffix.lower() == ".svg":
        return Picture(uri, None, None)
    try:
        with Image.open(path) as image:
            dpi = float(image.info.get("dpi", (_SHOWN_DPI,))[0])
            share = min(_SHOWN_DPI / dpi, 1.0) if dpi > 1 else 1.0
            return Picture(uri, round(image.width * share), round(image.height * share))
    except (OSError, UnidentifiedImageError) as error:
        raise _unreadable(path, str(error)) from None


def _unreadable(path: Path, reason: str) -> OutputError:
    return OutputError(f"{str(path)!r} cannot be read for the report: {reason}")
