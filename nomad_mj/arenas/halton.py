"""Starts spread evenly over a room: how the start sites of the rooms in `models/arenas` were made.

``python -m nomad_mj.arenas.halton ROOM.xml [COUNT]`` prints them as lines of MJCF.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np
import numpy.typing as npt

from nomad_mj.arenas.floor_plan import FloorPlan
from nomad_mj.errors import NomadError, StartError
from nomad_mj.guard import check_size
from nomad_mj.types import FloatArray

RADIUS = 0.265
"""Radius of the Nomad 200's perimeter [m]."""

ROBOT_HEIGHT = 0.9
CLEARANCE = 0.12
MIN_GOAL_DISTANCE = 1.2

_MOST_POINTS = 4096


def halton_starts(
    plan: FloorPlan,
    n: int,
    goal: npt.ArrayLike,
    radius: float = RADIUS,
    clearance: float = CLEARANCE,
    min_goal_distance: float = MIN_GOAL_DISTANCE,
    fewest: int | None = None,
) -> FloatArray:
    """Return the first points of the Halton sequence (bases 2 and 3) that can be starts.

    The sequence fills the rectangle around the places that can be reached from the goal; of a
    room with closed walls this is its interior.

    Parameters
    ----------
    plan : FloorPlan
        The room.
    n : int
        How many.
    goal, radius, clearance, min_goal_distance
        As of `FloorPlan.sample_free`.
    fewest : int, optional
        So many are enough where the room has no more; `n` by default.

    Returns
    -------
    ndarray, shape (n, 2), or fewer rows where `fewest` allows it

    Raises
    ------
    StartError
        If the goal is blocked or the room has not so many such places.
    """
    from scipy.stats import qmc  # takes half a second, and few ask for it

    low, high = np.reshape(plan.interior(0.0, goal).bounds, (2, 2))
    points = low + (high - low) * qmc.Halton(2, scramble=False).random(_MOST_POINTS)
    region = plan.interior(radius, goal)
    starts = points[plan.suit(points, region, radius, clearance, goal, min_goal_distance)]
    needed = n if fewest is None else fewest
    if len(starts) < needed:
        raise StartError(
            f"the room has only {len(starts)} of {needed} starts {clearance:g} m clear of "
            f"everything and {min_goal_distance:g} m from the goal; ask for fewer, or make room"
        )
    return starts[:n]


def main(arguments: Sequence[str] | None = None) -> None:
    """Print start sites for a room's file, whose goal is in it."""
    parser = argparse.ArgumentParser(
        prog="python -m nomad_mj.arenas.halton",
        description="Print evenly spread start sites for a room.",
        formatter_class=argparse.ArgumentDefaultsHelpFormatter,
    )
    parser.add_argument("room", help="MJCF file with a site called goal")
    parser.add_argument("count", type=int, nargs="?", default=50, help="how many")
    parser.add_argument("--radius", type=float, default=RADIUS, help="of the robot [m]")
    options = parser.parse_args(arguments)
    try:
        check_size("room", Path(options.room))
        model = mujoco.MjModel.from_xml_path(options.room)
        data = mujoco.MjData(model)
        mujoco.mj_kinematics(model, data)
        goal = data.site("goal").xpos[:2]
        plan = FloorPlan.from_model(model, ROBOT_HEIGHT)
        places = halton_starts(plan, options.count, goal, options.radius)
    except (ValueError, KeyError, NomadError) as error:
        reason = " ".join(str(error.args[0]).split())
        parser.error(f"room {options.room!r}: {reason}")
    for i, (x, y) in enumerate(places):
        print(f'    <site class="start" name="start_{i:02d}" pos="{x:.4f} {y:.4f} 0"/>')


if __name__ == "__main__":
    main()
