"""``nomad-mj check``."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import mujoco
import tyro
from dm_control.rl.control import PhysicsError
from rich.console import Console
from rich.table import Table
from rich.text import Text

from nomad_agents.checks import (
    Drift,
    draw_robot_card,
    drift_table,
    drive_patterns,
    find_drift_faults,
    find_faults,
    find_room_faults,
    robot_table,
    robot_values,
    room_values,
    sensor_table,
)
from nomad_agents.cli.common import console, print_json
from nomad_agents.experiments.figures import draw_starts
from nomad_agents.paths import expanded
from nomad_mj.assets import find_robot, find_room, list_robots, list_rooms
from nomad_mj.errors import ConfigError, ModelError, OutputError, StartError
from nomad_mj.guard import check_size
from nomad_mj.robots import find_sheet
from nomad_mj.scene import Scene, build_scene
from nomad_mj.tasks import MotorTask

_EMPTY = "empty_room"


@dataclass(frozen=True)
class Check:
    """Look a robot or a room over: what was found in its file, what is missing, how it drives."""

    file: tyro.conf.Positional[str]
    """MJCF file of a robot or a room, or the name of one that comes with the package."""
    robot: str = "nomad200"
    """Robot that a room is checked for."""
    out: Annotated[str, tyro.conf.arg(aliases=["-o"])] = "renders"
    """Folder for the picture."""
    no_drive: bool = False
    """Drive no test patterns."""
    json: bool = False
    """Print one line of JSON on standard output."""

    def run(self) -> int:
        """Print what was found; return 0, or 1 if something should be better."""
        room = is_room(self.file)
        out = _folder(self.out)
        screen = console(json_wanted=self.json)
        if room:
            return self._room(screen, out)
        scene = self._in_empty_room()
        path = out / f"check_{scene.robot.name}"
        faults = find_faults(scene)
        drifts: list[Drift] = []
        try:
            drifts = [] if self.no_drive else drive_patterns(self.file)
        except PhysicsError as error:
            faults.append(f"cannot be driven: {error}; look for tiny masses and stiff servos")
        faults += find_drift_faults(scene, drifts) if drifts else []
        draw_robot_card(scene, path)
        for table in (robot_table(scene, find_robot(self.file)), sensor_table(scene)):
            screen.print(table)
        if drifts:
            screen.print(drift_table(drifts))
        _print_faults(screen, faults, out / f"{path.name}.png")
        if self.json:
            print_json(
                robot_values(scene)
                | {"faults": faults, "patterns": [drift._asdict() for drift in drifts]}
            )
        return 1 if faults else 0

    def _in_empty_room(self) -> Scene:
        try:
            return build_scene(_EMPTY, self.file)
        except StartError as error:
            raise ConfigError(
                f"{self.file}: too large to be checked, which is done in {_EMPTY}, 10 x 10 m: "
                f"{error}"
            ) from None

    def _room(self, screen: Console, out: Path) -> int:
        scene = build_scene(self.file, self.robot)
        MotorTask(scene)  # whatever is wrong with what moves is said, too
        faults = find_room_faults(scene)
        path = out / f"check_{scene.arena.name}"
        draw_starts(scene, path)
        values = room_values(scene)
        table = Table("what", "found", title=f"Room {scene.arena.name}, for {self.robot}")
        for name, value in values.items():
            table.add_row(name.replace("_", " "), str(value))
        screen.print(table)
        _print_faults(screen, faults, out / f"{path.name}.png")
        if self.json:
            print_json(values | {"faults": faults})
        return 1 if faults else 0


def _folder(out: str) -> Path:
    folder = expanded(out)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot write {out!r}: {error.strerror}") from None
    return folder


def is_room(name: str) -> bool:
    """Return whether a name or a file is that of a room: no actuator, and a goal or no data sheet.

    Raises
    ------
    NomadError
        There is no such file; a file that cannot be read is left to whoever loads it.
    """
    if name in list_rooms() or name in list_robots():
        return name in list_rooms()
    if "/" not in name and not Path(name).suffix:
        known = sorted([*list_robots(), *list_rooms()])
        raise ModelError(f"unknown robot or room {name!r}; there are: {', '.join(known)}")
    path = find_room(name)
    check_size("room", path)
    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except (ValueError, RuntimeError, UnicodeDecodeError):
        return False
    if list(spec.actuators):
        return False
    # A plan or a map beside the room made of it looks like a data sheet.
    return spec.site("goal") is not None or not find_sheet(path)


def _print_faults(screen: Console, faults: list[str], picture: Path) -> None:
    for fault in faults:
        screen.print(Text.assemble(("!", "yellow"), f" {fault}"), soft_wrap=True)
    if not faults:
        screen.print("Nothing is missing.")
    screen.print(f"Picture: {picture}", soft_wrap=True)
