"""``nomad-mj room``."""

import math
from dataclasses import dataclass
from typing import Annotated

import tyro

from nomad_agents.checkpoint import write_atomically
from nomad_agents.cli.common import console, print_json
from nomad_agents.paths import expanded
from nomad_agents.task_options import parse_place
from nomad_mj.errors import ConfigError
from nomad_mj.rooms import (
    Room,
    concave_room,
    convex_room,
    furnish,
    maze_room,
    random_room,
    read_room,
    to_mjcf,
    wide_room,
)

_MADE = {
    "random": random_room,
    "convex": convex_room,
    "wide": wide_room,
    "concave": concave_room,
    "maze": maze_room,
}


@dataclass(frozen=True)
class MakeRoom:
    """Make a room's MJCF file of a map, an image or a plan, or make up a room or a maze."""

    source: tyro.conf.Positional[str]
    """Map or plan, .yaml, or image, .pgm or .png; or a word: random convex wide concave maze."""
    out: Annotated[str, tyro.conf.arg(aliases=["-o"])] = "room.xml"
    """The file to write, .xml."""
    resolution: float | None = None
    """Of an image: metres a pixel."""
    goal: str = ""
    """X,Y: where the goal is, in metres; the most open place by default."""
    starts: int | None = None
    """How many starts, spread evenly; up to 20 by default."""
    within: float = math.inf
    """Of a map, only what is no farther than so many metres from the goal in x and y."""
    seed: int | None = None
    """Of a room or a maze that is made up, 0 by default."""
    difficulty: float | None = None
    """Of these, from 0 to 1: more and larger obstacles, a larger maze; 0.5 by default."""
    json: bool = False
    """Print one line of JSON on standard output."""

    def run(self) -> int:
        """Write the room; return the exit code."""
        path = expanded(self.out)
        if path.suffix != ".xml":
            raise ConfigError(f"--out {self.out!r}: this writes .xml; give such a file")
        room = self._room()
        text = to_mjcf(room).encode()
        write_atomically(path, lambda file: file.write(text))
        things = len(room.walls) + len(room.obstacles)
        x0, y0, x1, y1 = room.bounds
        console(json_wanted=self.json).print(
            f"{path}: {x1 - x0:g} x {y1 - y0:g} m, {things} walls and obstacles, "
            f"{len(room.starts)} starts",
            soft_wrap=True,
        )
        if self.json:
            goal = list(room.goal or ())
            print_json(
                {"room": str(path), "things": things, "goal": goal, "starts": len(room.starts)}
            )
        return 0

    def _room(self) -> Room:
        goal = parse_place("goal", self.goal)
        if self.source not in _MADE:
            for option in ("seed", "difficulty"):
                if getattr(self, option) is not None:
                    raise ConfigError(
                        f"--{option}: only for a room that is made up: {', '.join(_MADE)}"
                    )
            return read_room(
                expanded(self.source),
                resolution=self.resolution,
                goal=goal,
                starts=self.starts,
                within=self.within,
            )
        if self.resolution is not None or math.isfinite(self.within):
            raise ConfigError(f"room {self.source}: takes no --resolution and no --within")
        difficulty = 0.5 if self.difficulty is None else self.difficulty
        return furnish(_MADE[self.source](self.seed or 0, difficulty), goal, self.starts)
