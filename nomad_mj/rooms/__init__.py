"""Rooms that are no MJCF: maps, plans, mazes and rooms made at random; and MJCF out of them."""

from nomad_mj.rooms.maze import maze_room
from nomad_mj.rooms.mjcf import to_mjcf
from nomad_mj.rooms.occupancy import FREE, OCCUPIED, UNKNOWN, Occupancy, room_of_map
from nomad_mj.rooms.places import furnish
from nomad_mj.rooms.plan_file import read_plan
from nomad_mj.rooms.random_room import concave_room, convex_room, random_room, wide_room
from nomad_mj.rooms.read import read_room
from nomad_mj.rooms.rectangles import merge_cells
from nomad_mj.rooms.room import Box, Cylinder, Polygon, Room
from nomad_mj.rooms.ros_map import read_floor_image, read_ros_map

__all__ = [
    "FREE",
    "OCCUPIED",
    "UNKNOWN",
    "Box",
    "Cylinder",
    "Occupancy",
    "Polygon",
    "Room",
    "concave_room",
    "convex_room",
    "furnish",
    "maze_room",
    "merge_cells",
    "random_room",
    "read_floor_image",
    "read_plan",
    "read_room",
    "read_ros_map",
    "room_of_map",
    "to_mjcf",
    "wide_room",
]
