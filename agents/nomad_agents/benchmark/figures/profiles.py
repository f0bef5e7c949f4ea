"""Performance profiles of all agents, a panel a set."""

from collections.abc import Mapping
from pathlib import Path

from nomad_agents.benchmark.figures.looks import look, signs
from nomad_agents.benchmark.figures.panels import draw_panels, panel_shape
from nomad_agents.benchmark.profiles import Profile
from nomad_agents.studies.style import grid, legend_below, sheet

_PANEL, _LEGEND = (3.3, 2.7), 0.9  # [in]


def draw_profiles(groups: Mapping[str, Mapping[str, Profile]], path: Path, score: str) -> None:
    """Draw a profile a panel and agent, with its band.

    Parameters
    ----------
    groups : mapping of str to mapping
        By the panel's title, profiles by agent.
    path : Path
        Without a suffix: a PDF and a PNG are written.
    score : str
        What is scored.
    """
    rows, columns = panel_shape(len(groups))
    labels = list(dict.fromkeys(label for profiles in groups.values() for label in profiles))
    width = max(_PANEL[0] * columns, 6.4)
    with sheet(path, width, _PANEL[1] * rows + _LEGEND) as figure:
        panels = draw_panels(figure, list(groups), f"{score} >")
        for axes, profiles in zip(panels, groups.values(), strict=True):
            for label, profile in profiles.items():
                seen = look(label)
                axes.fill_between(
                    profile.thresholds, profile.low, profile.high, color=seen.colour, alpha=0.13,
                    lw=0, step="post",
                )  # fmt: skip
                axes.step(
                    profile.thresholds, profile.share, where="post", color=seen.colour,
                    ls=seen.style, lw=seen.width,
                )  # fmt: skip
            axes.set_xlim(0, 1)
            axes.set_ylim(-0.02, 1.04)
            grid(axes, "both")
        figure.supylabel("share of runs above it", fontsize=12)
        legend_below(figure, signs(labels), 4 if columns > 2 else 3)
