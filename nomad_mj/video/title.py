"""A card in the middle of the picture that says what comes, or what came of it."""

from PIL import ImageDraw

from nomad_mj.video.cards import Card, make_card, rounded, text_width, write
from nomad_mj.video.layout import Box
from nomad_mj.video.palette import INK, MUTED

_TITLE, _SUBTITLE = 25, 17  # [px]


def title_card(title: str, subtitle: str, box: Box, unit: float) -> Card:
    """Return a card with a large and a small line, in the middle of a `box`."""
    lines = [(title, max(round(_TITLE * unit), 7), INK)]
    if subtitle:
        lines.append((subtitle, max(round(_SUBTITLE * unit), 6), MUTED))
    pad = round(0.95 * lines[0][1])
    space = box.width - 2 * pad
    lines = [(text, _fitting(text, letters, space), colour) for text, letters, colour in lines]
    widest = max(text_width(text, letters) for text, letters, _ in lines)
    width = min(widest + 2 * pad + round(8 * unit), box.width)
    height = round(sum(1.5 * letters for _, letters, _ in lines)) + pad
    card = rounded(width, height, 12 * unit, opacity=0.94)
    draw = ImageDraw.Draw(card)
    y = pad / 2
    for text, letters, colour in lines:
        left = max((width - text_width(text, letters)) / 2, 0.0)
        write(draw, (left, y + 0.75 * letters), text, letters, colour)
        y += 1.5 * letters
    x = box.x + (box.width - width) // 2
    return make_card(card, x, box.y + max(round(0.4 * box.height - height / 2), 0))


def _fitting(text: str, letters: int, space: int) -> int:
    """Return the size of the letters [px], smaller if the text is wider than the `space`."""
    return max(min(letters, int(letters * space / max(text_width(text, letters), 1))), 6)
