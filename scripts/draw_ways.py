"""Draw the ways of agents from one start of seed 0, side by side, for docs/agents.md.

    python scripts/draw_ways.py docs/images/corridor.png corridor 3 vfh dwa potential

The start is the number among those that `nomad-mj evaluate --seed 0` draws.
"""

import sys
import tempfile
from pathlib import Path

from nomad_agents.evaluation import draw_starts, evaluate
from nomad_agents.experiments.figures.paths import draw_paths
from nomad_agents.experiments.figures.room import Panel
from nomad_agents.experiments.pictures import Way
from nomad_agents.reactive_planner import TUNED
from nomad_agents.registry import make_agent

import nomad_mj


def main(out: str, room: str, number: str, *names: str) -> None:
    """Let each agent drive, then draw."""
    panels: list[Panel[list[Way]]] = []
    with nomad_mj.load("path_finding", room=room) as env:
        starts = draw_starts(env, int(number) + 1, 0)[-1:]
        for name in names:
            [trial] = evaluate(env, make_agent(name, env.scene.robot.layout, TUNED), starts, 0)
            ways: list[Way] = [{"reached": trial.episode.reached, "track": trial.track.tolist()}]
            panels.append(Panel(name, env.scene, ways))
    with tempfile.TemporaryDirectory() as folder:
        draw_paths(panels, Path(folder) / "ways", columns=len(panels))
        Path(out).write_bytes((Path(folder) / "ways.png").read_bytes())


if __name__ == "__main__":
    main(*sys.argv[1:])
