"""Whose a named element of a compiled scene is: the room's, the robot's or the scene's."""

ROOM_PREFIX = "room/"
ROBOT_PREFIX = "robot/"


def room_name(name: str) -> str:
    """Return the name that the room's own file gives an element; empty for one of the robot's.

    In a room compiled by itself, without a prefix, that is the name it has.
    """
    return "" if name.startswith(ROBOT_PREFIX) else name.removeprefix(ROOM_PREFIX)
