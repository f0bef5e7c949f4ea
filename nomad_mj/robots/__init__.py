"""What a robot file must offer, read from the compiled model."""

from nomad_mj.robots.description import (
    ACTUATORS,
    ENCODERS,
    JOINTS,
    RobotDescription,
    describe_robot,
)
from nomad_mj.robots.rays import set_rays_per_cone
from nomad_mj.robots.rings import PREFIX, RayIndex, group_rays
from nomad_mj.robots.surfaces import report_surfaces, unclip_surfaces

__all__ = [
    "ACTUATORS",
    "ENCODERS",
    "JOINTS",
    "PREFIX",
    "RayIndex",
    "RobotDescription",
    "describe_robot",
    "group_rays",
    "report_surfaces",
    "set_rays_per_cone",
    "unclip_surfaces",
]
