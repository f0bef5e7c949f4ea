"""What each agent looks like in all figures: a colour a family, a line a variant."""

from collections.abc import Sequence
from typing import NamedTuple

from matplotlib.lines import Line2D

from nomad_agents.studies.style import BLUE, FAINT, GOAL, INK, ORANGE, RED, VIOLET

_SKY, _PINK = "#4aa8dc", "#c2649f"
_FAMILIES = {
    "reactive_planner": (INK, "o"),
    "planner": (BLUE, "s"),
    "vfh": (ORANGE, "^"),
    "dwa": (VIOLET, "v"),
    "potential": (RED, "D"),
    "straight": (FAINT, "P"),
    "random": (FAINT, "X"),
    "sac": (GOAL, "<"),
    "td3": (_SKY, ">"),
    "ppo": (_PINK, "p"),
}
_LESS = ("faithful", "ranges")  # variants drawn dashed
_OTHERS = (RED, VIOLET, ORANGE, BLUE)


class Look(NamedTuple):
    """Colour, style and breadth of an agent's line, its mark, and whether the mark is filled."""

    colour: str
    style: str
    width: float
    mark: str
    filled: bool


def look(label: str) -> Look:
    """Return what an agent looks like, by ``NAME`` or ``NAME:VARIANT``."""
    name, _, variant = label.partition(":")
    unknown = _OTHERS[sum(map(ord, name)) % len(_OTHERS)], "*"
    colour, mark = _FAMILIES.get(name, unknown)
    less = variant in _LESS
    style = ":" if name == "random" else "--" if less else "-"
    return Look(colour, style, 2.4 if name == "reactive_planner" else 1.8, mark, not less)


def spoken(label: str) -> str:
    """Return an agent's name as people read it."""
    name, _, variant = label.partition(":")
    words = {"vfh": "VFH+", "dwa": "DWA", "sac": "SAC", "td3": "TD3", "ppo": "PPO"}
    shown = words.get(name, name.replace("_", " "))
    return f"{shown}, {variant}" if variant else shown


def signs(labels: Sequence[str]) -> list[Line2D]:
    """Return the lines that explain the agents in a legend."""
    return [
        Line2D([], [], color=each.colour, ls=each.style, lw=each.width, label=spoken(label))
        for label in labels
        for each in (look(label),)
    ]
