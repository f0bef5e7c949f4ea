"""What a compiled room tells about itself: goal, starts and cameras."""

from dataclasses import dataclass

import mujoco
import numpy as np
import shapely
from typing_extensions import Self

from nomad_mj.arenas.floor_plan import FloorPlan
from nomad_mj.arenas.footprints import FARTHEST
from nomad_mj.arenas.names import room_name
from nomad_mj.errors import ModelError, StartError
from nomad_mj.types import FloatArray


@dataclass(frozen=True, eq=False)
class Arena:
    """The places and cameras a room offers.

    Attributes
    ----------
    name : str
        Name of the room.
    goal : ndarray, shape (2,)
        World frame [m].
    starts : ndarray, shape (N, 3)
        x, y [m] and heading [rad] of each start, world frame, in the order of the file.
    start_names : tuple of str
        Names of their sites, as the room's file gives them.
    cameras : tuple of str
        Names of the room's own cameras, likewise.
    """

    name: str
    goal: FloatArray
    starts: FloatArray
    start_names: tuple[str, ...]
    cameras: tuple[str, ...]

    @classmethod
    def from_model(cls, model: mujoco.MjModel, name: str) -> Self:
        """Read a compiled room, with or without a robot in it.

        Parameters
        ----------
        model : mujoco.MjModel
            The room; its sites stand at their initial pose.
        name : str
            What to call it, also in errors: the room's name or file.

        Raises
        ------
        ModelError
            If the room has no goal or no start.
        """
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        sites = {room_name(model.site(i).name): i for i in range(model.nsite)}
        sites.pop("", None)
        starts = {site: i for site, i in sites.items() if site.startswith("start")}
        there = ", ".join(sites) or "none"
        if "goal" not in sites:
            raise ModelError(f"room {name!r} has no site named 'goal'; sites there are: {there}")
        if not starts:
            raise ModelError(
                f"room {name!r} has no site whose name begins with 'start'; "
                f"sites there are: {there}"
            )
        poses = np.array([_planar_pose(data, site) for site in starts.values()])
        for site in ("goal", *starts):
            if not (np.abs(data.site_xpos[sites[site]]) < FARTHEST).all():
                raise ModelError(
                    f"room {name!r}: site {site!r} is not within {FARTHEST:g} m of the origin"
                )
        cameras = filter(None, (room_name(model.camera(i).name) for i in range(model.ncam)))
        return cls(
            name, _planar_pose(data, sites["goal"])[:2], poses, tuple(starts), tuple(cameras)
        )


def check_arena(plan: FloorPlan, arena: Arena, radius: float) -> None:
    """Make sure that a robot fits at every start and at the goal and can go from one to the other.

    Parameters
    ----------
    plan : FloorPlan
        The room's plan.
    arena : Arena
        Its goal and starts.
    radius : float
        Radius of the robot's perimeter [m].

    Raises
    ------
    StartError
        Naming the first place that is wrong.
    """
    places = np.concatenate([arena.goal[None], arena.starts[:, :2]])
    names = ("goal", *arena.start_names)
    depth = -plan.clearance(places, radius)
    for name, place, overlap in zip(names, places, depth, strict=True):
        if overlap > 0:
            raise StartError(
                f"room {arena.name!r}: a robot of radius {radius:g} m at site {name!r} "
                f"({place[0]:.2f}, {place[1]:.2f}) overlaps {plan.nearest_name(place)!r} by "
                f"{overlap:.3f} m; move one of them by that much"
            )
    reached = plan.reaches(places, arena.goal, radius)
    for name, place, good in zip(names, places, reached, strict=True):
        if not good:
            raise StartError(
                f"room {arena.name!r}: a robot of radius {radius:g} m cannot reach the goal "
                f"({arena.goal[0]:.2f}, {arena.goal[1]:.2f}) from site {name!r} "
                f"({place[0]:.2f}, {place[1]:.2f}); {_advice(plan, (place, arena.goal), radius)}"
            )


def _advice(plan: FloorPlan, places: tuple[FloatArray, FloatArray], radius: float) -> str:
    """Say what to do where a robot cannot go between two places."""
    enclosed = plan.enclosed
    if enclosed is not None and len({bool(shapely.contains_xy(enclosed, *p)) for p in places}) == 2:
        return f"the floor is {plan.describe_bounds()}"
    return f"open a passage wider than {2 * radius:g} m"


def _planar_pose(data: mujoco.MjData, site: int) -> FloatArray:
    x, y, _ = data.site_xpos[site]
    rotation = data.site_xmat[site]
    return np.array([x, y, np.arctan2(rotation[3], rotation[0])])
