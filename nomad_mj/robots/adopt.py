"""Make a robot's file fit to be attached: what its data sheet says becomes names and numbers in it.

So that everything after this reads the compiled model alone, and a file that keeps to the names
needs no data sheet.
"""

import math
import re

import mujoco
import numpy as np

from nomad_mj.errors import ModelError
from nomad_mj.robots.sheet import MadeRing, Sheet
from nomad_mj.robots.steadying import steady_wheels

_UNRULED = re.compile(r"(steer|turret)(_\d+)?")  # motors whose angle is read, not their way


def adopt(spec: mujoco.MjSpec, sheet: Sheet, robot: str) -> None:
    """Change a robot's specification so that it can be attached and understood.

    Its own floor, lights, sky and keyframes go: the scene has these.

    Parameters
    ----------
    spec : mujoco.MjSpec
        Of the robot alone; changed in place.
    sheet : Sheet
        What its data sheet says.
    robot : str
        Its name, for messages.

    Raises
    ------
    ModelError
        The data sheet names an element that the file has not.
    """
    _undress(spec)
    _stand_at_origin(spec)
    for name in _rename_motors(spec, sheet, robot):
        _encode(spec, name)
    _make_servos(spec, sheet)
    steady_wheels(spec)
    for name, value in sheet.numbers.items():
        for old in [n for n in spec.numerics if n.name == name]:
            spec.delete(old)
        spec.add_numeric(name=name, data=[value], size=1)
    for name, text in (("drive", sheet.drive), ("base", sheet.base)):
        if text:
            _set_text(spec, name, text)
    if sheet.base and sheet.base not in [body.name for body in spec.bodies]:
        raise _missing(robot, "body", sheet.base, [body.name for body in spec.bodies])
    _name_bumpers(spec)
    listed = {ring: made for ring, made in sheet.rings.items() if not isinstance(made, MadeRing)}
    _rename_rings(spec, listed, robot)
    for ring, made in sheet.rings.items():
        if isinstance(made, MadeRing):
            _make_ring(spec, ring, made, robot)


def _set_text(spec: mujoco.MjSpec, name: str, data: str) -> None:
    """Give the file a custom text, in place of its own of that name."""
    for old in [text for text in spec.texts if text.name == name]:
        spec.delete(old)
    spec.add_text(name=name, data=data)


def _missing(robot: str, what: str, name: str, there: list[str]) -> ModelError:
    """Return the error about an element that the data sheet names and the file has not."""
    known = [other for other in there if other and other != "world"]
    listed = ", ".join(known[:12]) + (", ..." if len(known) > 12 else "") if known else "none"
    return ModelError(f"robot {robot!r} has no {what} {name!r}; there are: {listed}")


def _undress(spec: mujoco.MjSpec) -> None:
    """Take away what belongs to a scene and not to a robot."""
    for geom in list(spec.worldbody.geoms):
        spec.delete(geom)
    geoms = {geom.name for geom in spec.geoms}
    for pair in [p for p in spec.pairs if not {p.geomname1, p.geomname2} <= geoms]:
        spec.delete(pair)  # with the floor that has gone
    for light in list(spec.lights):
        spec.delete(light)
    for camera in list(spec.worldbody.cameras):
        spec.delete(camera)
    for key in list(spec.keys):
        spec.delete(key)
    for texture in [t for t in spec.textures if t.type == mujoco.mjtTexture.mjTEXTURE_SKYBOX]:
        spec.delete(texture)


def _stand_at_origin(spec: mujoco.MjSpec) -> None:
    """Let the robot's coordinates begin at the world's origin, as places of an episode do."""
    for body in spec.worldbody.bodies:
        body.pos = [0.0, 0.0, float(body.pos[2])]


def _rename_motors(spec: mujoco.MjSpec, sheet: Sheet, robot: str) -> list[str]:
    """Give the motors of a data sheet the names of their roles; return the names of all."""
    actuators = {a.name: a for a in spec.actuators if a.name}
    wheels: list[str] = []
    for role, names in sheet.motors.items():
        for number, name in enumerate(names):
            if name not in actuators:
                raise _missing(robot, "actuator", name, list(actuators))
            if role:
                _rename_actuator(spec, name, role if number == 0 else f"{role}_{number}")
            else:
                wheels.append(name)
    if wheels:
        _set_text(spec, "motors", "\n".join(wheels))  # a name may hold spaces
    return [a.name for a in spec.actuators if a.name]


def _rename_actuator(spec: mujoco.MjSpec, old: str, new: str) -> None:
    """Rename an actuator, and where sensors name it."""
    for actuator in spec.actuators:
        if actuator.name == new and new != old:
            actuator.name = f"{new}_of_file"
    for actuator in spec.actuators:
        if actuator.name == old:
            actuator.name = new
    for sensor in spec.sensors:
        if sensor.objtype == mujoco.mjtObj.mjOBJ_ACTUATOR and sensor.objname == old:
            sensor.objname = new


def _make_servos(spec: mujoco.MjSpec, sheet: Sheet) -> None:
    """Make velocity servos of a data sheet's wheels, if it says how stiff and how fast."""
    gain, speed = (sheet.numbers.get(name) for name in ("servo_gain", "servo_max_speed"))
    if gain is None or speed is None:
        return
    wheels = {*sheet.motors.get("", ())}
    if sheet.drive == "car":
        wheels |= {a.name for a in spec.actuators if re.fullmatch(r"drive(_\d+)?", a.name)}
    for actuator in spec.actuators:
        if actuator.name in wheels:
            gear = abs(float(actuator.gear[0])) or 1.0  # gain and speed are those of the wheel
            actuator.set_to_velocity(kv=gain / gear**2)
            actuator.ctrlrange, actuator.ctrllimited = [-speed * gear, speed * gear], True


def _encode(spec: mujoco.MjSpec, actuator: str) -> None:
    """Add an encoder to a motor that has none: its speed, from which its way is summed."""
    kind = mujoco.mjtSensor.mjSENS_ACTUATORVEL
    there = [s for s in spec.sensors if s.type == kind and s.objname == actuator]
    if not there and not _UNRULED.fullmatch(actuator):
        spec.add_sensor(
            name=_free_name(f"{actuator}_encoder", {s.name for s in spec.sensors}),
            type=kind,
            objtype=mujoco.mjtObj.mjOBJ_ACTUATOR,
            objname=actuator,
        )


def _free_name(wanted: str, taken: set[str]) -> str:
    """Return a name that nothing has yet."""
    while wanted in taken:
        wanted += "_"
    return wanted


def _name_bumpers(spec: mujoco.MjSpec) -> None:
    """Give touch sensors that have no name one."""
    taken = {sensor.name for sensor in spec.sensors}
    for number, sensor in enumerate(spec.sensors):
        if sensor.type == mujoco.mjtSensor.mjSENS_TOUCH and not sensor.name:
            sensor.name = _free_name(f"bumper_{number}", taken)


def _rename_rings(spec: mujoco.MjSpec, rings: dict[str, tuple[str, ...]], robot: str) -> None:
    """Give rangefinders the names of their rings' single rays; others of these rings go."""
    kind = mujoco.mjtSensor.mjSENS_RANGEFINDER
    finders = {s.name: s for s in spec.sensors if s.type == kind}
    named: set[str] = set()
    for ring, names in rings.items():
        for name in names:
            if name not in finders:
                raise _missing(robot, "rangefinder", name, list(finders))
            if name in named:
                raise ModelError(f"robot {robot!r}: ring {ring!r} names {name!r} a second time")
            named.add(name)
    for name, sensor in finders.items():
        if name not in named and any(re.fullmatch(rf"{re.escape(r)}(_\d+)+", name) for r in rings):
            spec.delete(sensor)
        elif name in named:
            sensor.name = f"ring of its data sheet {name}"  # so that no two meet on the way
    for ring, names in rings.items():
        for cone, name in enumerate(names):
            finders[name].name = f"{ring}_{cone:03d}"


def _make_ring(spec: mujoco.MjSpec, ring: str, made: MadeRing, robot: str) -> None:
    """Add the sites and rangefinders of a ring."""
    kind, name = mujoco.mjtSensor.mjSENS_RANGEFINDER, re.compile(rf"{re.escape(ring)}(_\d+)+")
    if there := [s.name for s in spec.sensors if s.type == kind and name.fullmatch(s.name)]:
        raise ModelError(
            f"robot {robot!r}: ring {ring!r} of its data sheet is to be made, but the file has "
            f"{there[0]!r}; call it otherwise"
        )
    body = spec.body(made.body) if made.body else _base(spec)
    if body is None:
        raise _missing(robot, "body", made.body, [b.name for b in spec.bodies])
    for cone, bearing in enumerate(made.bearings):
        for ray, off in enumerate(np.linspace(-made.half_angle, made.half_angle, made.rays)):
            angle, axis = math.radians(bearing + (off if made.rays > 1 else 0.0)), bearing
            place = math.radians(axis)
            name = f"{ring}_{ray}_{cone:03d}" if made.rays > 1 else f"{ring}_{cone:03d}"
            body.add_site(
                name=name,
                pos=[made.distance * math.cos(place), made.distance * math.sin(place), made.height],
                quat=_looking(angle),
                size=[0.003, 0.003, 0.003],
                group=4,
            )
            sensor = spec.add_sensor(
                name=name,
                type=mujoco.mjtSensor.mjSENS_RANGEFINDER,
                objtype=mujoco.mjtObj.mjOBJ_SITE,
                objname=name,
            )
            sensor.cutoff = made.range[1]
            sensor.intprm = [1, 0, 0]
    if f"{ring}_min_range" not in [numeric.name for numeric in spec.numerics]:
        spec.add_numeric(name=f"{ring}_min_range", data=[made.range[0]], size=1)


def _base(spec: mujoco.MjSpec) -> "mujoco.MjsBody | None":
    """Return the body that a ring belongs to where nothing else is said."""
    given = [t.data for t in spec.texts if t.name == "base"]
    if given:
        return spec.body(given[0])
    tops = list(spec.worldbody.bodies)
    named = [body for body in tops if body.name == "base"]
    return (named or tops or [None])[0]


def _looking(angle: float) -> list[float]:
    """Return the rotation after which the z axis points level, at an angle from x [rad]."""
    quat = np.empty(4)
    turn = np.array([math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)])
    level = np.array([math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0])  # z to x
    mujoco.mju_mulQuat(quat, turn, level)
    return quat.tolist()
