"""The data sheet of a robot: a small YAML file beside its MJCF, for what names do not tell.

``my_robot.yaml`` beside ``my_robot.xml``, or ``robot.yaml`` in the same folder. Every key is
optional; `docs/your-own-robot.md` explains them.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from nomad_mj.errors import ModelError
from nomad_mj.robots.rings import TAKEN
from nomad_mj.values import number, numbers, read_yaml, refuse_others

KINDS = ("synchro", "differential", "omni", "car")
ROLES = {"synchro": ("translate", "steer", "turret"), "car": ("drive", "steer")}
_KEYS = ("drive", "base", "motors", "numbers", "rings")
_NUMBERS = (
    "radius",
    "translate_max_speed",
    "translate_max_acceleration",
    "turn_max_speed",
    "turn_max_acceleration",
    "steer_max_acceleration",
    "wheel_radius",
    "track",
    "wheelbase",
    "servo_gain",
    "servo_max_speed",
)
_OF_RING, _OF_WHEEL = "<ring>_min_range", "<motor>_rollers"
_MADE = ("body", "count", "bearings", "distance", "height", "half_angle", "rays", "range")
_MOST_CONES, _MOST_RAYS = 720, 64


@dataclass(frozen=True)
class MadeRing:
    """A ring of range sensors to add to a robot that has none.

    Attributes
    ----------
    body : str
        That it is fixed to; the base if empty.
    bearings : tuple of float
        Direction of each cone [deg], 0 ahead, counter-clockwise.
    distance, height : float
        From the body's origin to where rays begin, outwards and upwards [m].
    half_angle : float
        Half the opening of a cone [deg]; 0 for single rays.
    rays : int
        Rays of a cone.
    range : (float, float)
        Shortest and longest reading [m].
    """

    body: str
    bearings: tuple[float, ...]
    distance: float
    height: float
    half_angle: float
    rays: int
    range: tuple[float, float]


@dataclass(frozen=True)
class Sheet:
    """What a data sheet says; empty where it says nothing.

    Attributes
    ----------
    drive, base : str
        Kind of drive; name of the body whose x axis is ahead.
    motors : dict
        Names of actuators of each role; all under ``""`` where the kind has no roles.
    numbers : dict
        Values in place of the file's custom numerics.
    rings : dict
        Of each ring the names of its rangefinders in order, or what to make it of.
    """

    drive: str = ""
    base: str = ""
    motors: dict[str, tuple[str, ...]] = field(default_factory=dict)
    numbers: dict[str, float] = field(default_factory=dict)
    rings: dict[str, tuple[str, ...] | MadeRing] = field(default_factory=dict)


def find_sheet(robot: Path) -> Path | None:
    """Return the data sheet of a robot's file, None if there is none."""
    for path in (robot.with_suffix(".yaml"), robot.with_name("robot.yaml")):
        if path.is_file():
            return path
    return None


def read_sheet(robot: Path) -> Sheet:
    """Return what the data sheet beside a robot's file says.

    Raises
    ------
    ModelError
        A key that there is not, or a value that makes no sense: names it and says what is right.
    """
    path = find_sheet(robot)
    if path is None:
        return Sheet()
    held = read_yaml(path, "robot")
    what = f"robot file {str(path)!r}:"
    refuse_others(held, _KEYS, what)
    drive = _text(held.get("drive", ""), f"{what} drive")
    if drive and drive not in KINDS:
        raise ModelError(f"{what} drive {drive!r}: must be one of {', '.join(KINDS)}")
    values = _mapping(held.get("numbers", {}), f"{what} numbers")
    ends = tuple(each.partition(">")[2] for each in (_OF_RING, _OF_WHEEL))
    others = [name for name in values if not name.endswith(ends)]
    refuse_others(dict.fromkeys(others), (*_NUMBERS, _OF_RING, _OF_WHEEL), f"{what} numbers")
    rings = _mapping(held.get("rings", {}), f"{what} rings")
    for name in rings:
        if name in TAKEN or not name:
            raise ModelError(f"{what} ring {name!r}: must have a name of its own, such as sonar")
        if re.search(r"_\d+$", name):
            raise ModelError(
                f"{what} ring {name!r}: must not end in a number, as its rays do; call it "
                "lidar_front, say"
            )
    return Sheet(
        drive,
        _text(held.get("base", ""), f"{what} base"),
        _motors(held.get("motors", {}), drive, f"{what} motors"),
        {name: number(value, f"{what} {name}", -1e4, 1e4) for name, value in values.items()},
        {name: _ring(ring, f"{what} ring {name!r}") for name, ring in rings.items()},
    )


def _text(value: Any, what: str) -> str:
    if not isinstance(value, str):
        raise ModelError(f"{what} {value!r}: must be a name")
    return value


def _names(value: Any, what: str) -> tuple[str, ...]:
    """Return names, of which there is one at least."""
    listed = [value] if isinstance(value, str) else value
    if not isinstance(listed, list) or not listed:
        raise ModelError(f"{what}: must be a name or a list of names")
    return tuple(_text(name, what) for name in listed)


def _mapping(value: Any, what: str) -> dict[str, Any]:
    if not isinstance(value, dict) or not all(isinstance(key, str) for key in value):
        raise ModelError(f"{what}: must be names with their values")
    return value


def _motors(value: Any, drive: str, what: str) -> dict[str, tuple[str, ...]]:
    """Return the actuators of each role."""
    if isinstance(value, list):
        if drive in ROLES:
            roles = ", ".join(f"{role}: ..." for role in ROLES[drive])
            raise ModelError(f"{what}: a drive {drive!r} has roles; write {{{roles}}}")
        return {"": _names(value, what)}
    found = _mapping(value, what)
    if found and drive not in ROLES:
        raise ModelError(f"{what}: must be a list of the wheels' actuators, or drive must be given")
    if found:
        refuse_others(found, ROLES[drive], what)
    return {role: _names(names, f"{what} {role}") for role, names in found.items()}


def _whole(value: Any, what: str, most: int) -> int:
    found = number(value, what, 1, most)
    if found != int(found):
        raise ModelError(f"{what} {found:g}: must be a whole number")
    return int(found)


def _ring(value: Any, what: str) -> tuple[str, ...] | MadeRing:
    if not isinstance(value, dict):
        return _names(value, what)
    refuse_others(value, _MADE, what)
    if ("count" in value) == ("bearings" in value):
        raise ModelError(f"{what}: needs count, or bearings [deg] (one of the two)")
    if "count" in value:
        count = _whole(value["count"], f"{what} count", _MOST_CONES)
        bearings = tuple(360.0 * k / count for k in range(count))
    else:
        bearings = numbers(value["bearings"], f"{what} bearings", 1, _MOST_CONES)
    least, most = numbers(value.get("range", [0.0, 5.0]), f"{what} range", 2, low=0.0)
    if not least < most:
        raise ModelError(f"{what} range [{least:g}, {most:g}]: must be the least and the greatest")
    half = number(value.get("half_angle", 0.0), f"{what} half_angle", 0.0, 90.0)
    rays = _whole(value.get("rays", 3 if half else 1), f"{what} rays", _MOST_RAYS)
    return MadeRing(
        _text(value.get("body", ""), f"{what} body"),
        bearings,
        number(value.get("distance", 0.0), f"{what} distance", 0.0, 100.0),
        number(value.get("height", 0.0), f"{what} height", -100.0, 100.0),
        half,
        rays if half else 1,
        (least, most),
    )
