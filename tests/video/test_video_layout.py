import numpy as np
import pytest

from nomad_mj.errors import ConfigError, UnknownNameError
from nomad_mj.video.layout import VIEWS, default_size, inset_height, make_layout

SIZES = [(640, 480), (1120, 480), (320, 240), (480, 480), (480, 640), (1280, 720), (64, 64)]


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("size", SIZES)
def test_panes_tile_the_picture_without_overlap(view: str, size: tuple[int, int]) -> None:
    layout = make_layout(view, size)
    drawn = np.zeros((size[1], size[0]), dtype=int)
    for pane in layout.panes:
        x, y, width, height = pane.box
        assert x >= 0 and y >= 0 and x + width <= size[0] and y + height <= size[1]
        drawn[y : y + height, x : x + width] += 1
    assert drawn.max() == 1
    assert {pane.camera for pane in layout.panes} <= {"chase", "top", "overview"}


@pytest.mark.parametrize("view", VIEWS)
def test_a_view_has_its_default_size(view: str) -> None:
    assert make_layout(view).size == default_size(view)


@pytest.mark.parametrize("size", [(640, 480), (800, 480), (1280, 720)])
def test_from_above_the_caption_begins_below_the_inset(size: tuple[int, int]) -> None:
    layout = make_layout("top", size)
    assert layout.caption.y > layout.inset[1] + inset_height(layout.unit)
    assert layout.caption.x + layout.caption.width <= layout.panes[0].box.x


def test_a_narrow_pane_from_above_is_no_higher_than_wide() -> None:
    for view in ("top", "side"):
        top = make_layout(view, (400, 640)).panes[-1]
        assert top.camera == "top"
        assert top.box.height <= top.box.width


@pytest.mark.parametrize("size", [(641, 480), (640, 481), (0, 480), (62, 64), (640, 5000)])
def test_a_size_no_video_can_have_is_refused(size: tuple[int, int]) -> None:
    with pytest.raises(ConfigError, match="must be an even number from 64 to 4096 pixels"):
        make_layout("chase", size)


def test_an_unknown_view_lists_what_there_is() -> None:
    with pytest.raises(UnknownNameError, match="'below'; there are: chase, overview, side, top"):
        make_layout("below")
