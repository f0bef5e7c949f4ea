"""Images of maps as numbers: PGM, PNG and BMP."""

import os
import warnings
from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from nomad_mj.errors import ModelError
from nomad_mj.rooms.rectangles import Mask
from nomad_mj.types import FloatArray

MOST_PIXELS = 4096 * 4096
SUFFIXES = (".pgm", ".png", ".bmp")
_FORMATS = ("PPM", "PNG", "BMP")


def read_image(path: Path) -> tuple[FloatArray, Mask]:
    """Return the brightness of an image's pixels and which of them are opaque.

    Parameters
    ----------
    path : Path
        A PGM (plain or binary), PNG or BMP file; colours are averaged.

    Returns
    -------
    brightness : ndarray, shape (R, C)
        From 0, black, to 1, white; row 0 is the top.
    opaque : ndarray of bool, shape (R, C)

    Raises
    ------
    ModelError
        No such file, no image, one that is too large, or grey with a shade that is transparent.
    """
    name = str(path) if len(str(path)) <= 200 else f"{str(path)[:197]}..."
    what = f"map image {name!r}"
    if not os.path.isfile(path):  # noqa: PTH113 - unlike Path.is_file no error for long names
        raise ModelError(f"{what} does not exist; a map's YAML file names it relative to itself")
    try:
        with warnings.catch_warnings(), path.open("rb") as file:
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            image = Image.open(file, formats=_FORMATS)
            if image.width * image.height > MOST_PIXELS:
                raise ModelError(
                    f"{what} has {image.width} x {image.height} pixels; at most "
                    f"{MOST_PIXELS // 2**20} million: cut it or make it coarser"
                )
            if "transparency" in image.info and image.mode not in ("P", "RGB"):
                raise ModelError(
                    f"{what} has a transparent shade of grey: give it an alpha channel"
                )
            return _brightness(image)
    except UnidentifiedImageError:
        raise ModelError(f"{what} is no PGM, PNG or BMP image") from None
    except (OSError, ValueError, SyntaxError, EOFError, Image.DecompressionBombError) as error:
        reason = " ".join(str(error).split())[:200]
        raise ModelError(f"{what} is no PGM, PNG or BMP image: {reason}") from None


def _brightness(image: Image.Image) -> tuple[FloatArray, Mask]:
    if image.mode.startswith("I"):  # 16 bits
        values = np.asarray(image, dtype=np.float64) / 65535
        return values, np.ones(values.shape, dtype=np.bool_)
    if image.mode == "1" or image.mode == "L":
        values = np.asarray(image.convert("L"), dtype=np.float64) / 255
        return values, np.ones(values.shape, dtype=np.bool_)
    pixels = np.asarray(image.convert("RGBA"), dtype=np.float64) / 255
    return pixels[..., :3].mean(axis=-1), np.asarray(pixels[..., 3] == 1)
