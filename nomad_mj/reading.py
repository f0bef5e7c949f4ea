"""Read the MJCF files of a room and of a robot, and make them fit to be put into one scene."""

import warnings
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from pathlib import Path

import mujoco

from nomad_mj.errors import ModelError
from nomad_mj.guard import check_size
from nomad_mj.robots import adopt, read_sheet, report_surfaces, set_rays_per_cone

_FLOOR_SLACK = 1e-3  # [m]


@contextmanager
def quietly() -> Generator[list[str], None, None]:
    """Collect the engine's warnings instead of printing them."""
    said: list[str] = []
    previous = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(said.append)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            yield said
    finally:
        mujoco.set_mju_user_warning(previous)


def _read(kind: str, path: Path) -> mujoco.MjSpec:
    check_size(kind, path)
    with quietly() as said:
        try:
            spec = mujoco.MjSpec.from_file(str(path))
            spec.copy().compile()
        except (ValueError, RuntimeError, UnicodeDecodeError) as error:
            reason = " ".join(str(error).split())
            if path.suffix != ".xml":
                reason += "; its name must end in .xml (nomad-mj room makes one of a map)"
            raise ModelError(f"{kind} file {str(path)!r} is not valid MJCF: {reason}") from None
    if any("NaN" in warning for warning in said):
        raise ModelError(f"{kind} file {str(path)!r} holds a NaN; give a number in its place")
    return spec


def read_room(path: Path) -> mujoco.MjSpec:
    """Return a room without the floor and the lights that serve where its file is alone.

    Raises
    ------
    ModelError
        A plane that is not its floor.
    """
    spec = _read("room", path)
    compiled = spec.copy()
    with quietly():
        model = compiled.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    pairs = list(zip(spec.geoms, compiled.geoms, strict=True))
    for geom, place in [(g, c.id) for g, c in pairs if g.type == mujoco.mjtGeom.mjGEOM_PLANE]:
        if data.geom_xmat[place, 8] < 1 - _FLOOR_SLACK:
            continue  # it is not level: see `FloorPlan`
        if model.geom_bodyid[place] or abs(data.geom_xpos[place, 2]) > _FLOOR_SLACK:
            raise ModelError(
                f"room file {str(path)!r}: plane {geom.name!r} is no floor at height 0; write what "
                "stands in the room as boxes or other solids"
            )
        spec.delete(geom)
    for light in list(spec.lights):
        spec.delete(light)
    return spec


def read_robot(
    path: Path, rays_per_cone: int | None, specular_rings: Sequence[str]
) -> mujoco.MjSpec:
    """Return a robot with the rays that the options ask for."""
    spec = _read("robot", path)
    try:
        adopt(spec, read_sheet(path), path.stem)
        if rays_per_cone is not None:
            set_rays_per_cone(spec, rays_per_cone)
    except ValueError as error:  # the engine's, of names that meet
        raise ModelError(f"robot file {str(path)!r}: {' '.join(str(error).split())}") from None
    report_surfaces(spec, specular_rings)
    return spec
