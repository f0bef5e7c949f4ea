"""Panels side by side, one a set of tasks, with one name of the axis below each column."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

_COLUMNS = 3


def panel_shape(count: int) -> tuple[int, int]:
    """Return in how many rows and columns so many panels stand."""
    columns = min(_COLUMNS, count)
    return -(-count // columns), columns


def draw_panels(figure: Figure, titles: Sequence[str], below: str) -> list[Axes]:
    """Return a panel for each title, `below` written under the lowest of each column."""
    rows, columns = panel_shape(len(titles))
    every = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).flat
    for axes in every[len(titles) :]:
        axes.set_visible(False)
    panels: list[Axes] = list(every[: len(titles)])
    for number, (axes, title) in enumerate(zip(panels, titles, strict=True)):
        lowest = number + columns >= len(titles)
        axes.set_title(title)
        axes.tick_params(labelbottom=lowest)
        axes.set_xlabel(below if lowest else "")
    return panels
