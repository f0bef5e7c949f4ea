"""Colours, path, cards and inset: what needs no OpenGL."""

import numpy as np
import pytest
from PIL import Image as Pillow

from nomad_mj.video.caption import Caption, CaptionBar
from nomad_mj.video.cards import make_card, spell
from nomad_mj.video.inset import inset_card
from nomad_mj.video.layout import Box, make_layout
from nomad_mj.video.marks import Sheet
from nomad_mj.video.palette import BLUE, GREEN, GREY, ORANGE, RGB, blend, range_colours
from nomad_mj.video.title import title_card
from nomad_mj.video.trail import Trail

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def test_the_ramp_ends_in_its_colours() -> None:
    ends = blend([BLUE, GREEN, ORANGE], [0.0, 0.5, 1.0, 2.0])
    np.testing.assert_allclose(ends, [BLUE, GREEN, ORANGE, ORANGE], atol=1e-6)


def test_nearer_readings_are_darker_and_more_opaque() -> None:
    colours = range_colours(np.linspace(0.0, 3.0, 50), 3.0)
    assert colours.shape == (50, 4)
    assert (np.diff(colours[:, :3] @ LUMINANCE) > -1e-9).all()
    assert (np.diff(colours[:, 3]) < 0).all()
    np.testing.assert_array_equal(range_colours(np.array([np.inf]), 3.0)[0], colours[-1])


def drive(trail: Trail, *places: tuple[float, float]) -> None:
    """Drive along straight lines from the place of the last bend."""
    here = trail.tail[0]
    for place in np.array(places):
        for share in np.linspace(0.0, 1.0, 34)[1:]:
            trail.extend(here + share * (place - here))
        here = place


def test_a_straight_drive_is_one_piece() -> None:
    trail = Trail(np.zeros(2))
    drive(trail, (1.0, 0.5))
    bends, colours = trail.bends()
    assert len(bends) == 1 and not colours
    np.testing.assert_array_equal(trail.tail[0], [0.0, 0.0])


def test_bends_and_ways_back_are_kept() -> None:
    trail = Trail(np.zeros(2))
    drive(trail, (1.0, 0.0), (1.0, 1.0), (1.0, 0.4))
    bends, _ = trail.bends()
    np.testing.assert_allclose(bends, [[0, 0], [1, 0], [1, 1]], atol=0.05)


def test_a_curve_stays_within_two_centimetres() -> None:
    angle = np.linspace(0.0, np.pi, 300)
    arc = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    trail = Trail(arc[0])
    for place in arc[1:]:
        trail.extend(place)
    bends, _ = trail.bends()
    assert 5 < len(bends) < 40
    middles = (bends[1:] + bends[:-1]) / 2
    assert (np.abs(np.hypot(*middles.T) - 1) < 0.02).all()


def test_each_decision_leaves_a_dot_and_its_colour() -> None:
    trail = Trail(np.zeros(2))
    trail.stop(BLUE)
    drive(trail, (1.0, 0.0))
    trail.stop(ORANGE)
    drive(trail, (2.0, 0.0))
    assert [colour for _, colour in trail.stops] == [BLUE, ORANGE]
    np.testing.assert_allclose([place for place, _ in trail.stops], [[0, 0], [1, 0]], atol=1e-9)
    bends, colours = trail.bends()
    np.testing.assert_allclose(bends[-1], [1, 0], atol=1e-9)
    assert colours[-1] == BLUE and trail.tail[1] == ORANGE


def area(sheet: Sheet) -> float:
    return sum(abs(np.linalg.det(axes.reshape(3, 3)[:2, :2])) / 2 for _, axes, _ in sheet.triangles)


def test_triangles_fill_what_they_should() -> None:
    ribbon, arrow = Sheet(), Sheet()
    points = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 4.0], [3.0, 5.0]])
    ribbon.ribbon(points, [BLUE] * 3, 0.1, 0.0)
    assert area(ribbon) == pytest.approx(0.1 * 6)
    arrow.arrow(np.zeros(2), np.array([1.0, 0.0]), 0.1, 0.0, BLUE)
    assert area(arrow) == pytest.approx(0.1 * 0.68 + 0.3 * 0.32 / 2)
    arrow.arrow(np.zeros(2), np.zeros(2), 0.1, 0.0, BLUE)
    assert len(arrow.triangles) == 3


@pytest.mark.parametrize("alpha", [0, 1, 127, 254, 255])
def test_cards_blend_exactly(alpha: int) -> None:
    rng = np.random.default_rng(0)
    top = rng.integers(0, 256, (16, 16, 3), dtype=np.uint8)
    frame = rng.integers(0, 256, (16, 16, 3), dtype=np.uint8)
    picture = Pillow.fromarray(top)
    picture.putalpha(alpha)
    expected = np.rint((top * float(alpha) + frame * (255.0 - alpha)) / 255)
    make_card(picture, 0, 0).lay_over(frame)
    np.testing.assert_array_equal(frame, expected)


def test_a_card_may_stick_out() -> None:
    frame = np.zeros((10, 10, 3), dtype=np.uint8)
    make_card(Pillow.new("RGBA", (8, 8), (255, 0, 0, 255)), 6, 7).lay_over(frame)
    assert (frame[7:, 6:, 0] == 255).all() and frame[..., 0].sum() == 255 * 12


def test_letters_that_the_font_lacks_are_replaced() -> None:
    assert spell("z \u2212 0.1 \u00d7 \u4e2d") == "z - 0.1 x ?"


def near(pixels: np.ndarray, colour: RGB, tolerance: int = 12) -> np.ndarray:
    return np.abs(pixels.astype(int) - 255 * np.array(colour)).max(axis=-1) < tolerance


def test_the_inset_shows_north_up_and_the_move() -> None:
    grid = np.zeros((21, 21))
    grid[-3:] = 1.0  # rows run along y: the last ones lie in the north
    frame = np.full((200, 200, 3), 255, dtype=np.uint8)
    card = inset_card(
        grid, np.array([1.5, 0.0]), cell=0.2, radius=0.265, colour=ORANGE, place=(5, 5), unit=1.0
    )
    card.lay_over(frame)
    occupied = np.argwhere(frame.sum(axis=-1) < 400)
    orange = np.argwhere(near(frame, ORANGE))
    middle = occupied.mean(axis=0)
    assert len(occupied) > 21 * 3 * 20 and len(orange) > 30
    assert middle[0] < orange[:, 0].min()
    assert orange[:, 1].mean() > 5 + card.behind.shape[1] / 2


@pytest.mark.parametrize("view", ["chase", "top"])
def test_the_caption_shows_its_badge_and_the_time(view: str) -> None:
    layout = make_layout(view)
    bar = CaptionBar(layout.caption, layout.unit, speed=2.0)
    blank = np.full((480, 640, 3), 90, dtype=np.uint8)
    caption = Caption("planned", ORANGE, (("decision", "3"), ("category", "17")))
    first, later, again = blank.copy(), blank.copy(), blank.copy()
    bar.lay_over(first, caption, 1.0)
    bar.lay_over(later, caption, 61.23)
    bar.lay_over(again, caption, 1.04)
    np.testing.assert_array_equal(first, again)
    assert near(first, ORANGE).sum() > 500
    changed = np.argwhere((first != later).any(axis=-1))
    assert len(changed) > 30
    assert changed[:, 1].min() > layout.caption.x + 0.4 * layout.caption.width
    x, y, width, height = layout.caption
    outside = np.ones(blank.shape[:2], dtype=bool)
    outside[y : y + height, x : x + width] = False
    assert (first[outside] == 90).all()


def test_a_long_caption_stays_clear_of_the_time() -> None:
    layout = make_layout("chase")
    fields = tuple(("quantity", str(10**n)) for n in range(9))
    frame = np.zeros((480, 640, 3), dtype=np.uint8)
    CaptionBar(layout.caption, layout.unit).lay_over(frame, Caption("reacted", BLUE, fields), 100.0)
    bare = np.zeros((480, 640, 3), dtype=np.uint8)
    CaptionBar(layout.caption, layout.unit).lay_over(bare, Caption("", GREY), 100.0)
    right = layout.caption.x + layout.caption.width - 70
    np.testing.assert_array_equal(frame[:, right:], bare[:, right:])


def test_a_long_title_is_written_smaller_instead_of_cut_off() -> None:
    card = title_card("Learning to reach the goal from fifty starts", "", Box(0, 0, 320, 240), 1.0)
    middle = card.colour[card.colour.shape[0] // 2 - 4 :][:8].min(axis=(0, 2))
    written = np.flatnonzero(middle < 0.6 * middle.max())
    assert card.behind.shape[1] <= 320
    assert 8 < written[0] < 40 and 8 < len(middle) - written[-1] < 40


def test_a_title_is_centred_and_never_wider_than_its_box() -> None:
    card = title_card("goal reached", "7 decisions", Box(0, 0, 640, 480), 1.0)
    assert card.x == (640 - card.behind.shape[1]) // 2
    long = title_card("a" * 200, "", Box(100, 0, 64, 64), 0.1)
    assert long.behind.shape[1] <= 64 and long.x >= 100 and long.y >= 0
