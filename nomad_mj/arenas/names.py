"""Whose a named element of a compiled scene is: the room's, the robot's or the scene's."""

import mujoco

ROOM_PREFIX = "room/"
ROBOT_PREFIX = "robot/"
MOVING = "moving"  # begins the names of the bodies that move


def room_name(name: str) -> str:
    """Return the name that the room's own file gives an element; empty for one of the robot's.

    In a room compiled by itself, without a prefix, that is the name it has.
    """
    return "" if name.startswith(ROBOT_PREFIX) else name.removeprefix(ROOM_PREFIX)


def goal_site(model: mujoco.MjModel) -> int:
    """Return the index of the room's goal site; -1 if there is none."""
    return next((i for i in range(model.nsite) if room_name(model.site(i).name) == "goal"), -1)


def is_moving(model: mujoco.MjModel, body: int) -> bool:
    """Whether a body, or the body of the world that it is on, is one that the task moves."""
    root = int(model.body_rootid[body])
    named = room_name(model.body(root).name).startswith(MOVING)
    return named and int(model.body_mocapid[root]) >= 0
