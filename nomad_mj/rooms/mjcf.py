"""From a room to the MJCF file that `nomad_mj.load` and MuJoCo's own viewer open."""

import math
import re
from collections.abc import Iterator

from nomad_mj.rooms.cameras import room_cameras
from nomad_mj.rooms.room import Cylinder, Polygon, Room, Shape

_COLOURS = ("0.80 0.52 0.42 1", "0.56 0.66 0.54 1", "0.86 0.73 0.50 1", "0.47 0.57 0.67 1")
_WIDEST_VIEW = 180.0  # [m] the engine takes no orthographic camera that sees as much
_HEAD = """\
  <default>
    <default class="wall">
      <geom type="box" rgba="0.64 0.63 0.615 1"/>
    </default>
    <default class="goal">
      <site type="cylinder" size="0.22 0.004" rgba="0.16 0.62 0.48 1"/>
    </default>
    <default class="start">
      <site type="cylinder" size="0.05 0.003" rgba="0.35 0.38 0.42 1" group="4"/>
    </default>
  </default>
"""


def to_mjcf(room: Room) -> str:
    """Return the room as the text of an MJCF file; the same room gives the same text.

    Like the rooms that come with the package it holds no floor, light or physics options: the
    scene that it is loaded into does, and MuJoCo's viewer brings a headlight.

    Parameters
    ----------
    room : Room
        Its goal and its starts are written if it has them. Lengths are rounded to 1 um.
    """
    meshes = [shape for shape in (*room.walls, *room.obstacles) if isinstance(shape, Polygon)]
    names = {id(mesh): f"prism_{number}" for number, mesh in enumerate(meshes)}
    lines = [f'<mujoco model="{_safe(room.name)}">\n{_HEAD}']
    if meshes:
        lines.append("  <asset>")
        lines += [_mesh(mesh, names[id(mesh)], room.height) for mesh in meshes]
        lines.append("  </asset>\n")
    lines.append("  <worldbody>")
    for number, shape in enumerate(room.walls):
        lines.append(_geom(shape, f'class="wall" name="wall_{number}"', room.height, names))
    for number, shape in enumerate(room.obstacles):
        colour = _COLOURS[number % len(_COLOURS)]
        what = f'name="obstacle_{number}" rgba="{colour}"'
        lines.append(_geom(shape, what, room.height, names))
    lines += [*_sites(room), *_cameras(room), "  </worldbody>", "</mujoco>", ""]
    return "\n".join(lines)


def _safe(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9_.-]+", "_", name) or "room"


def _text(*values: float) -> str:
    """Return numbers as MJCF has them, without a negative zero."""
    return " ".join(f"{round(value, 6) + 0.0:.10g}" for value in values)


def _turn(angle: float) -> str:
    degrees = round(math.degrees(angle), 6)
    return f' euler="0 0 {_text(degrees)}"' if degrees else ""


def _geom(shape: Shape, what: str, height: float, meshes: dict[int, str]) -> str:
    if isinstance(shape, Polygon):
        return f'    <geom {what} type="mesh" mesh="{meshes[id(shape)]}"/>'
    place = _text(shape.x, shape.y, height / 2)
    if isinstance(shape, Cylinder):
        size = _text(shape.radius, height / 2)
        return f'    <geom {what} type="cylinder" pos="{place}" size="{size}"/>'
    size = _text(shape.length / 2, shape.width / 2, height / 2)
    return f'    <geom {what} type="box" pos="{place}" size="{size}"{_turn(shape.angle)}/>'


def _mesh(shape: Polygon, name: str, height: float) -> str:
    corners = [_text(*corner, z) for z in (0.0, height) for corner in shape.corners]
    return f'    <mesh name="{name}" vertex="{"  ".join(corners)}"/>'


def _sites(room: Room) -> Iterator[str]:
    if room.goal is not None:
        yield f'    <site class="goal" name="goal" pos="{_text(*room.goal, 0.004)}"/>'
    digits = len(str(max(len(room.starts) - 1, 0)))
    for number, (x, y, heading) in enumerate(room.starts):
        name = f"start_{number:0{digits}d}"
        yield f'    <site class="start" name="{name}" pos="{_text(x, y, 0)}"{_turn(heading)}/>'


def _cameras(room: Room) -> Iterator[str]:
    (top, side), (overview, angle) = room_cameras(room)
    pose = f'pos="{_text(*top)}" projection="orthographic"'
    if side < _WIDEST_VIEW:  # videos look at larger rooms with a camera of their own
        yield f'    <camera name="top" {pose} fovy="{_text(side)}"/>'
    pose = f'pos="{_text(*overview)}" xyaxes="1 0 0 0 0.775 0.632"'
    yield f'    <camera name="overview" {pose} fovy="{_text(angle)}"/>'
