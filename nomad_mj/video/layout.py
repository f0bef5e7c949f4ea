"""Where on a picture the views, the inset and the caption lie."""

from typing import NamedTuple

from nomad_mj.errors import ConfigError, UnknownNameError

VIEWS = ("chase", "top", "overview", "side")
"""Behind the robot; from straight above; the whole room at an angle; chase and top together."""

Size = tuple[int, int]

_SMALLEST, _LARGEST = 64, 4096
_CELLS = 21
_ASPECTS = {"top": 1.0, "overview": 4 / 3}  # least width by height that shows a square room


class Box(NamedTuple):
    """A rectangle of pixels; `y` runs down from the top of the picture."""

    x: int
    y: int
    width: int
    height: int


class Pane(NamedTuple):
    """A rectangle that shows the room through one camera."""

    camera: str
    box: Box


class Layout(NamedTuple):
    """A picture's parts.

    Attributes
    ----------
    size : (int, int)
        Width and height of the picture [px].
    panes : tuple of Pane
        What is drawn in three dimensions.
    unit : float
        Pixels that stand for one at 640 x 480: text and lines grow with the picture.
    inset : (int, int)
        Upper left corner of the inset.
    caption : Box
        The caption's place: a single line, or a column where it is higher than wide.
    """

    size: Size
    panes: tuple[Pane, ...]
    unit: float
    inset: tuple[int, int]
    caption: Box


def default_size(view: str) -> Size:
    """Return the size [px] that suits a view."""
    return {"side": (1120, 480), "overview": (800, 480)}.get(view, (640, 480))


def check_size(size: Size) -> Size:
    """Return `size` if a video can have it.

    Raises
    ------
    ConfigError
        It is odd, too small or too large.
    """
    width, height = size
    for name, pixels in (("width", width), ("height", height)):
        if not _SMALLEST <= pixels <= _LARGEST or pixels % 2:
            raise ConfigError(
                f"picture {width} x {height}: its {name} must be an even number from "
                f"{_SMALLEST} to {_LARGEST} pixels"
            )
    return width, height


def make_layout(view: str, size: Size | None = None) -> Layout:
    """Return the layout of a view.

    Parameters
    ----------
    view : str
        One of `VIEWS`.
    size : (int, int), optional
        Width and height of the picture [px]; `default_size` if None.

    Raises
    ------
    UnknownNameError
        There is no such view.
    ConfigError
        A size that a video cannot have.
    """
    if view not in VIEWS:
        raise UnknownNameError("view", view, VIEWS)
    width, height = check_size(size or default_size(view))
    if view == "side":
        right = min(height, width // 2)
        left = width - right
        panes = (
            Pane("chase", Box(0, 0, left, height)),
            Pane("top", _fit(Box(left, 0, right, height), "top")),
        )
        return _overlaid((width, height), panes, left)
    if view == "chase":
        return _overlaid((width, height), (Pane(view, Box(0, 0, width, height)),), width)
    return _beside(view, width, height)


def bare_layout(view: str, size: Size) -> Layout:
    """Return the layout of a picture that one view fills, with nothing beside it.

    Parameters
    ----------
    view : str
        One of `VIEWS` but "side".
    size : (int, int)
        Width and height of the picture [px].

    Raises
    ------
    UnknownNameError, ConfigError
        As of `make_layout`.
    """
    alone = [name for name in VIEWS if name != "side"]
    if view not in alone:
        raise UnknownNameError("view", view, alone)
    width, height = check_size(size)
    return _overlaid((width, height), (Pane(view, Box(0, 0, width, height)),), width)


def _fit(box: Box, camera: str) -> Box:
    """Return the box, lower if it is so narrow that its sides would cut off the room."""
    height = min(box.height, round(box.width / _ASPECTS[camera]))
    return Box(box.x, box.y + (box.height - height) // 2, box.width, height)


def _overlaid(size: Size, panes: tuple[Pane, ...], width: int) -> Layout:
    """Lay inset and caption over the pane on the left."""
    unit = min(width / 640, size[1] / 480)
    edge = round(12 * unit)
    line = max(round(36 * unit), 8)
    caption = Box(edge, size[1] - edge - line, width - 2 * edge, line)
    return Layout(size, panes, unit, (edge, edge), caption)


def _beside(view: str, width: int, height: int) -> Layout:
    """Lay inset and caption beside the room if there is space, else the caption below it."""
    column = round(height / 3)
    if width - column >= 0.95 * _ASPECTS[view] * height:
        unit = height / 480
        edge = round(8 * unit)
        box = _fit(Box(column, 0, width - column, height), view)
        below = inset_height(unit) + 2 * edge
        caption = Box(edge, below, column - 2 * edge, height - below - edge)
        return Layout((width, height), (Pane(view, box),), unit, (edge, edge), caption)
    unit = min(width / 640, height / 480)
    line = max(round(36 * unit), 8)
    edge = round(6 * unit)
    box = _fit(Box(0, 0, width, height - line - 2 * edge), view)
    caption = Box(edge, height - line - edge, width - 2 * edge, line)
    return Layout((width, height), (Pane(view, box),), unit, (edge, edge), caption)


def inset_side(unit: float) -> int:
    """Return how wide and high the grid in the inset is [px], of whatever number of cells."""
    return _CELLS * max(round(6 * unit), 1)


def inset_height(unit: float) -> int:
    """Return how high the inset is: the grid, its title and a margin around both."""
    return inset_side(unit) + round(41 * unit)
