"""Time large rooms against `clutter`: an office of 1000 x 1000 cells, or the room files given.

    python scripts/time_large_map.py [ROOM.xml ...]

By the CPU's time; a control step is the best of short blocks, each room's in turn with clutter's.
"""

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from PIL import Image

import nomad_mj
from nomad_mj.rooms import read_room, to_mjcf
from nomad_mj.tasks import MotorEnvironment

sys.path.append(str(Path(__file__).parent.parent))
from tests.rooms.office import office

SEEDS, BLOCKS, STEPS = 5, 100, 10
_ACTION = (0.25, 0.4, 0.0)  # round in a circle, so that few walls are touched


def cpu_time(work: Callable[[], object]) -> float:
    """Return how long some work keeps the CPU [s]."""
    began = time.process_time()
    work()
    return time.process_time() - began


def convert(folder: Path, noise: float) -> tuple[Path, float]:
    """Draw an office as a map of ROS's, read it; return the room's file and the time [s]."""
    grid = office(1000, noise)
    shades = np.array([254, 0, 205], dtype=np.uint8)[grid.cells]  # free, occupied, unknown
    Image.fromarray(shades[::-1]).save(folder / "map.png")
    (folder / "map.yaml").write_text(
        f"image: map.png\nresolution: {grid.resolution}\norigin: [0, 0, 0]\n"
    )
    path = folder / f"office_{noise:g}.xml"
    return path, cpu_time(lambda: path.write_text(to_mjcf(read_room(folder / "map.yaml"))))


def drive(env: MotorEnvironment) -> None:
    """Go on for a few control steps."""
    for _ in range(STEPS):
        env.step(_ACTION)


def report(room: Path) -> None:
    """Print what a room costs."""
    began = time.process_time()
    env = nomad_mj.load("motor", room, task_kwargs={"ends_at_goal": False})
    env.reset(seed=0)
    loading = time.process_time() - began
    there, simulated = env.task.scene.model.ngeom, env.physics.model.ngeom
    print(f"{room.name}: loaded in {loading:.2f} s, {simulated} of {there} geoms simulated")
    clutter = nomad_mj.load("motor", "clutter", task_kwargs={"ends_at_goal": False})
    for seed in range(SEEDS):
        env.reset(seed=seed)
        clutter.reset(seed=seed)
        pairs = [
            (cpu_time(lambda: drive(env)), cpu_time(lambda: drive(clutter))) for _ in range(BLOCKS)
        ]
        mine, other = np.min(pairs, axis=0) / STEPS * 1e6
        print(f"  seed {seed}: {mine:.0f} us a control step, clutter {other:.0f}", end="")
        print(f", {mine / other:.2f} x", flush=True)
    env.close()
    clutter.close()


def main(rooms: list[str]) -> None:
    """Report on room files, or on offices with walls ragged and straight."""
    if rooms:
        for room in rooms:
            report(Path(room))
        return
    with tempfile.TemporaryDirectory() as folder:
        for noise in (0.02, 0.0):
            path, seconds = convert(Path(folder), noise)
            print(f"map with noise {noise:g} read in {seconds:.1f} s")
            report(path)


if __name__ == "__main__":
    main(sys.argv[1:])
