"""Text and pictures on cards, drawn once with Pillow and laid over every frame with numpy."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from PIL import Image as Pillow
from PIL import ImageDraw, ImageFont

from nomad_mj.video.canvas import Image
from nomad_mj.video.palette import PAPER, RGB

_SMOOTH = 4  # shapes are drawn so much larger, then reduced
_OPACITY = 0.9
_SPELT = str.maketrans({"\u2212": "-", "\u2013": "-", "\u2014": "-", "\u00d7": "x"})


class Card(NamedTuple):
    """A picture to lay over frames.

    Attributes
    ----------
    x, y : int
        Its upper left corner.
    colour : array (height, width, 3) of uint16
        Colour times opacity, times 255.
    behind : array (height, width, 1) of uint16
        255 less the opacity.
    """

    x: int
    y: int
    colour: npt.NDArray[np.uint16]
    behind: npt.NDArray[np.uint16]

    def lay_over(self, frame: Image) -> None:
        """Blend the card into a frame; what sticks out is cut off."""
        target = frame[self.y : self.y + self.behind.shape[0], self.x :]
        target = target[:, : self.behind.shape[1]]
        height, width, _ = target.shape
        mixed = target * self.behind[:height, :width]
        mixed += self.colour[:height, :width]
        mixed += 128
        target[...] = (mixed + (mixed >> 8)) >> 8  # divides by 255, exactly


def make_card(picture: Pillow.Image, x: int, y: int) -> Card:
    """Return an RGBA picture as a card."""
    pixels = np.asarray(picture.convert("RGBA"), dtype=np.uint16)
    alpha = pixels[..., 3:]
    return Card(x, y, pixels[..., :3] * alpha, 255 - alpha)


def to_bytes(colour: RGB, opacity: float = 1.0) -> tuple[int, int, int, int]:
    """Return a colour as Pillow wants it."""
    red, green, blue = (round(255 * part) for part in colour)
    return red, green, blue, round(255 * opacity)


@lru_cache(maxsize=32)
def font(size: int) -> ImageFont.FreeTypeFont:
    """Return Aileron, the font that comes with Pillow, `size` pixels high."""
    loaded = ImageFont.load_default(size)
    assert isinstance(loaded, ImageFont.FreeTypeFont)
    return loaded


def spell(text: str) -> str:
    """Return `text` in the letters that the font has: those of Latin-1."""
    return text.translate(_SPELT).encode("latin-1", "replace").decode("latin-1")


def text_width(text: str, size: int) -> int:
    """Return how many pixels a line of text takes."""
    return round(font(size).getlength(spell(text)))


def write(
    draw: ImageDraw.ImageDraw, place: tuple[float, float], text: str, size: int, colour: RGB
) -> None:
    """Write a line of text; `place` is its left end, half way up the small letters."""
    x, y = place
    # Digits and capitals are 0.72 of the size high: they stand centred on the line.
    draw.text((x, y + 0.36 * size), spell(text), to_bytes(colour), font(size), anchor="ls")


def rounded(
    width: int, height: int, radius: float, colour: RGB = PAPER, opacity: float = _OPACITY
) -> Pillow.Image:
    """Return a rectangle with smooth round corners on a transparent ground."""
    large = Pillow.new("L", (width * _SMOOTH, height * _SMOOTH), 0)
    box = (0, 0, width * _SMOOTH - 1, height * _SMOOTH - 1)
    ImageDraw.Draw(large).rounded_rectangle(box, radius * _SMOOTH, fill=round(255 * opacity))
    picture = Pillow.new("RGBA", (width, height), to_bytes(colour))
    picture.putalpha(large.resize((width, height), Pillow.Resampling.BOX))
    return picture
