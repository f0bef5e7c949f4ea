"""What a robot file must offer, read from the compiled model."""

from nomad_mj.robots.adopt import adopt
from nomad_mj.robots.description import (
    RobotDescription,
    describe_robot,
    robot_geoms,
    solid_radius,
)
from nomad_mj.robots.extent import collides, reach
from nomad_mj.robots.naming import PREFIX
from nomad_mj.robots.rays import set_rays_per_cone
from nomad_mj.robots.rings import RayIndex, group_rays
from nomad_mj.robots.sheet import Sheet, find_sheet, read_sheet
from nomad_mj.robots.surfaces import report_surfaces, unclip_surfaces

__all__ = [
    "PREFIX",
    "RayIndex",
    "RobotDescription",
    "Sheet",
    "adopt",
    "collides",
    "describe_robot",
    "find_sheet",
    "group_rays",
    "reach",
    "read_sheet",
    "report_surfaces",
    "robot_geoms",
    "set_rays_per_cone",
    "solid_radius",
    "unclip_surfaces",
]
