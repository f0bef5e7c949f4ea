"""The caption: what was decided, and the time."""

from typing import NamedTuple

from PIL import Image as Pillow
from PIL import ImageDraw

from nomad_mj.video.canvas import Image
from nomad_mj.video.cards import Card, make_card, rounded, text_width, write
from nomad_mj.video.layout import Box
from nomad_mj.video.palette import GREY, INK, MUTED, PAPER, RGB

_TEXT = 17  # [px]


class Caption(NamedTuple):
    """What is said about the present decision.

    Attributes
    ----------
    badge : str
        A word that stands out, on its colour.
    colour : RGB
        Of the badge, of the path and of the move.
    fields : tuple of (label, value)
        What else there is to say.
    """

    badge: str = ""
    colour: RGB = GREY
    fields: tuple[tuple[str, str], ...] = ()


class CaptionBar:
    """Draws captions and clocks; the same caption is drawn once, the clock ten times a second.

    Parameters
    ----------
    box : Box
        Where; a column if it is higher than wide.
    unit : float
        Size of the picture (see `Layout`).
    speed : float
        Said beside the time, unless it is 1.
    """

    def __init__(self, box: Box, unit: float, speed: float = 1.0) -> None:
        self._box, self._unit = box, unit
        self._suffix = "" if speed == 1.0 else f"{speed:g}x"
        self._size = max(round(_TEXT * unit), 6)
        self._caption: tuple[Caption, Card] | None = None
        self._clock: tuple[tuple[str, int], Card] | None = None
        self._column = box.height > box.width

    def lay_over(self, frame: Image, caption: Caption, time: float) -> None:
        """Write the caption and the time [s] on a frame."""
        if self._caption is None or self._caption[0] != caption:
            picture = self._draw_column(caption) if self._column else self._draw_line(caption)
            self._caption = caption, make_card(picture, self._box.x, self._box.y)
        text = f"{max(time, 0.0):.1f} s"
        rows = len(caption.fields) + bool(caption.badge)
        if self._clock is None or self._clock[0] != (text, rows):
            self._clock = (text, rows), self._draw_clock(text, rows)
        self._caption[1].lay_over(frame)
        self._clock[1].lay_over(frame)

    @property
    def _line_height(self) -> int:
        return round(1.75 * self._size)

    @property
    def _pad(self) -> int:
        return round(0.65 * self._size)

    def _badge(self, caption: Caption, size: int) -> Pillow.Image:
        width = text_width(caption.badge, size) + round(1.3 * size)
        height = round(1.45 * size)
        badge = rounded(width, height, height / 2, caption.colour, 1.0)
        write(ImageDraw.Draw(badge), (0.65 * size, height / 2), caption.badge, size, PAPER)
        return badge

    def _draw_line(self, caption: Caption) -> Pillow.Image:
        """Return the caption as one line, in smaller letters if it would not fit."""
        _, _, width, height = self._box
        card = rounded(width, height, 9 * self._unit)
        room = width - self._clock_width("100.0 s") - 2 * self._pad
        size = self._size
        while size > 6 and self._line_width(caption, size) > room:
            size -= 1
        draw = ImageDraw.Draw(card)
        x, middle = float(self._pad), height / 2
        if caption.badge:
            badge = self._badge(caption, size)
            card.alpha_composite(badge, (round(0.55 * x), (height - badge.height) // 2))
            x += badge.width + 0.5 * size
        for label, value in caption.fields:
            write(draw, (x, middle), label, size, MUTED)
            x += text_width(label, size) + (0.35 * size if label else 0.0)
            write(draw, (x, middle), value, size, INK)
            x += text_width(value, size) + 1.1 * size
        return card

    def _line_width(self, caption: Caption, size: int) -> float:
        width = text_width(caption.badge, size) + 1.8 * size if caption.badge else 0.0
        for label, value in caption.fields:
            width += text_width(label, size) + text_width(value, size) + 1.45 * size
        return width

    def _draw_column(self, caption: Caption) -> Pillow.Image:
        """Return the caption as lines, one below the other, with the time at the bottom."""
        width, line, pad, size = self._box.width, self._line_height, self._pad, self._size
        rows = len(caption.fields) + bool(caption.badge) + 1
        card = rounded(width, min(rows * line + 2 * pad, self._box.height), 9 * self._unit)
        draw = ImageDraw.Draw(card)
        y = pad + line / 2
        if caption.badge:
            badge = self._badge(caption, size)
            card.alpha_composite(badge, (round(0.8 * pad), round(y - badge.height / 2)))
            y += line
        for label, value in caption.fields:
            write(draw, (pad, y), label, size, MUTED)
            write(draw, (width - pad - text_width(value, size), y), value, size, INK)
            y += line
        return card

    def _clock_width(self, text: str) -> int:
        """Return the width of the time and of what is said beside it."""
        beside = text_width(self._suffix, self._size) + round(0.6 * self._size)
        digits = sum(letter.isdigit() for letter in text)
        others = "".join(letter for letter in text if not letter.isdigit())
        width = digits * text_width("0", self._size) + text_width(others, self._size)
        return width + (beside if self._suffix else 0)

    def _draw_clock(self, text: str, rows: int) -> Card:
        """Return the time, digits as wide as each other so that they stand still."""
        box, size, pad = self._box, self._size, self._pad
        height = self._line_height if self._column else box.height
        width = box.width if self._column else self._clock_width(text) + pad
        picture = Pillow.new("RGBA", (width, height), (0, 0, 0, 0))
        draw = ImageDraw.Draw(picture)
        x, middle = float(width - self._clock_width(text) - pad), height / 2
        if self._column:
            write(draw, (pad, middle), "time", size, MUTED)
        if self._suffix:
            write(draw, (x, middle), self._suffix, size, MUTED)
            x += text_width(self._suffix, size) + 0.6 * size
        for letter in text:
            write(draw, (x, middle), letter, size, INK)
            x += text_width("0" if letter.isdigit() else letter, size)
        y = box.y + pad + rows * height if self._column else box.y
        return make_card(picture, box.x + box.width - width, y)
