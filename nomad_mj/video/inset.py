"""The inset: the certainty grid around the robot, and the move that was chosen on it."""

import numpy as np
from PIL import Image as Pillow
from PIL import ImageDraw

from nomad_mj.types import FloatArray
from nomad_mj.video.cards import Card, make_card, rounded, text_width, to_bytes, write
from nomad_mj.video.layout import inset_side
from nomad_mj.video.palette import INK, MUTED, PAPER, RGB, blend

_GRID: tuple[RGB, ...] = ((0.955, 0.962, 0.970), (0.69, 0.75, 0.82), (0.20, 0.30, 0.46))
_SMOOTH = 4
_TITLE = 15  # [px]


def _grid_picture(grid: FloatArray, pixels: int) -> Pillow.Image:
    """Return the cells, north up, with thin gaps between them."""
    colours = np.round(255 * blend(_GRID, grid[::-1])).astype(np.uint8)
    cells = np.repeat(np.repeat(colours, pixels, axis=0), pixels, axis=1)
    if pixels >= 3:
        gap = np.uint8(255 * 0.90)
        lighter = (cells // 3 + (gap // 3) * 2).astype(np.uint8)
        line = np.arange(len(cells)) % pixels == pixels - 1
        cells[line] = lighter[line]
        cells[:, line] = lighter[:, line]
    return Pillow.fromarray(cells)


def _draw_move(draw: ImageDraw.ImageDraw, middle: float, move: FloatArray, colour: RGB) -> None:
    """Draw an arrow from the middle; `move` in large pixels, y down."""
    length = float(np.hypot(move[0], move[1]))
    thick = 0.026 * 2 * middle
    if length < 2 * thick:
        return
    along = move / length
    across = np.array([-along[1], along[0]])
    start = np.array([middle, middle])
    end = start + move
    neck = end - min(3.2 * thick, length) * along
    for grow, paint in ((0.55 * thick, PAPER), (0.0, colour)):
        shaft = thick / 2 + grow
        wing = 1.5 * thick + 1.3 * grow
        tip = end + 1.6 * grow * along
        base = neck - grow * along
        outline = [
            start - shaft * across,
            base - shaft * across,
            base - wing * across,
            tip,
            base + wing * across,
            base + shaft * across,
            start + shaft * across,
        ]
        draw.polygon([(float(x), float(y)) for x, y in outline], fill=to_bytes(paint)[:3])


def _map(
    grid: FloatArray, cell: float, radius: float, move: FloatArray | None, colour: RGB, pixels: int
) -> Pillow.Image:
    """Return the grid with the robot and its move on it."""
    small = _grid_picture(grid, pixels)
    width = small.width * _SMOOTH
    large = small.resize((width, width), Pillow.Resampling.NEAREST)
    draw = ImageDraw.Draw(large)
    middle = width / 2
    scale = pixels * _SMOOTH / cell
    disc = radius * scale
    for grow, paint in ((0.012 * width, PAPER), (0.0, INK)):
        r = disc + grow
        box = (middle - r, middle - r, middle + r, middle + r)
        draw.ellipse(box, fill=to_bytes(paint)[:3])
    if move is not None:
        _draw_move(draw, middle, np.array([move[0], -move[1]]) * scale, colour)
    return large.resize(small.size, Pillow.Resampling.BOX)


def inset_card(
    grid: FloatArray,
    move: FloatArray | None,
    *,
    cell: float,
    radius: float,
    colour: RGB,
    place: tuple[int, int],
    unit: float,
) -> Card:
    """Return the inset.

    Parameters
    ----------
    grid : array (N, N)
        Occupancy probabilities; rows along y, oriented as the world, the robot in the middle.
    move : array (2,), optional
        The chosen displacement [m], oriented as the world.
    cell, radius : float
        Side of a cell and radius of the robot [m].
    colour : RGB
        Of the move.
    place : (int, int)
        Upper left corner on the picture.
    unit : float
        Size of the picture (see `Layout`).
    """
    side = inset_side(unit)
    picture = _map(grid, cell, radius, move, colour, max(round(side / len(grid)), 1))
    if picture.width > side:  # of a grid with more cells than there are pixels
        picture = picture.resize((side, side), Pillow.Resampling.BOX)
    pad = max(round(9 * unit), 2)
    size = max(round(_TITLE * unit), 6)
    while size > 6 and text_width("certainty gridNN", size) > picture.width:
        size -= 1
    title = round(1.55 * size)
    width, height = picture.width + 2 * pad, picture.height + 2 * pad + title
    card = rounded(width, height, 9 * unit)
    card.paste(picture, (pad, pad + title))
    draw = ImageDraw.Draw(card)
    middle = pad + 0.42 * title
    write(draw, (pad, middle), "certainty grid", size, MUTED)
    north = width - pad - text_width("N", size)
    write(draw, (north, middle), "N", size, MUTED)
    x, half = north - 0.55 * size, 0.30 * size
    tip = [
        (x, middle - 1.1 * half),
        (x - 0.8 * half, middle + half),
        (x + 0.8 * half, middle + half),
    ]
    draw.polygon(tip, fill=to_bytes(MUTED))
    return make_card(card, *place)
