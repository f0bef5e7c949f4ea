"""Pictures and videos of an environment."""

from nomad_mj.video.caption import Caption
from nomad_mj.video.costs import FrameCosts, frame_costs
from nomad_mj.video.layout import VIEWS, default_size
from nomad_mj.video.palette import BLUE, GREY, ORANGE
from nomad_mj.video.recorder import EpisodeRecorder
from nomad_mj.video.stills import snapshot

__all__ = [
    "BLUE",
    "GREY",
    "ORANGE",
    "VIEWS",
    "Caption",
    "EpisodeRecorder",
    "FrameCosts",
    "default_size",
    "frame_costs",
    "snapshot",
]
