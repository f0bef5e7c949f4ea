"""How all figures look, and how they are written: vector PDF and PNG of the same."""

import io
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from pathlib import Path

import matplotlib.style
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox

from nomad_agents.checkpoint import write_atomically

INK = "#23313f"
FAINT = "#8b96a3"
OBSTACLE = "#c9ced6"
# Told apart with any colour vision (after Okabe and Ito), and by shape as well wherever they meet.
GOAL = "#0f8a68"
ORANGE = "#d9822b"
BLUE = "#2c6fbb"
RED = "#b9442e"
VIOLET = "#6f4aa8"
OURS, PLANNER_COLOUR, STRAIGHT_COLOUR = INK, BLUE, ORANGE
FORMATS = (".pdf", ".png")
WIDTH = 6.4  # [in] of a figure of one panel
_DPI = 160
_MARGIN = 0.06  # [in]
_STYLE = {
    "font.size": 12,  # still read where a figure is printed at half its size
    "axes.titlesize": 13,
    "axes.titlelocation": "left",
    "axes.titlecolor": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": FAINT,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.labelsize": 11,
    "ytick.labelsize": 11,
    "xtick.major.size": 3,
    "ytick.major.size": 3,
    "legend.frameon": False,
    "legend.fontsize": 11,
    "lines.solid_capstyle": "round",
    "lines.solid_joinstyle": "round",
    "pdf.fonttype": 42,  # text that can be searched and edited
}


@contextmanager
def sheet(path: Path, width: float, height: float) -> Generator[Figure, None, None]:
    """Yield an empty figure [in] to draw on, then write it as PDF and as PNG.

    The same drawing gives the same bytes, whatever style the user has set.

    Parameters
    ----------
    path : Path
        Without a suffix.
    width, height : float
        Of the page [in].

    Raises
    ------
    OutputError
        A file cannot be written.
    """
    with matplotlib.style.context(["default", _STYLE]):
        figure = Figure(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(figure)
        yield figure
        figure.draw_without_rendering()
        figure.set_layout_engine("none")  # it is laid out: once is enough
        around = figure.get_tightbbox().padded(_MARGIN)
        for suffix in FORMATS:
            _save(figure, path.parent / f"{path.name}{suffix}", around)


def _save(figure: Figure, path: Path, around: Bbox) -> None:
    buffer = io.BytesIO()
    dated = {"CreationDate": None} if path.suffix == ".pdf" else {}
    figure.savefig(
        buffer,
        format=path.suffix[1:],
        dpi=_DPI,
        metadata=dated,
        bbox_inches=around,
    )
    write_atomically(path, lambda file: file.write(buffer.getvalue()))


def legend_below(figure: Figure, handles: Sequence[Artist], columns: int = 0) -> None:
    """Explain the signs below the panels, in one line unless `columns` are given."""
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=columns or len(handles),
        columnspacing=1.4,
        handletextpad=0.5,
    )


def grid(axes: Axes, which: str = "y") -> None:
    """Lay faint lines under the data along the ticks of an axis, "x", "y" or "both"."""
    axes.grid(axis=which, color=OBSTACLE, linewidth=0.6, alpha=0.7)  # type: ignore[arg-type]
    axes.set_axisbelow(True)
