"""``nomad-mj record``."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from nomad_agents.cli.common import console, interruptible, output_file, print_json
from nomad_agents.cli.evaluate import choose_starts, require_decisions
from nomad_agents.recording import record
from nomad_agents.registry import find_agent, find_config
from nomad_agents.task_options import TaskOptions
from nomad_mj.tasks import Start
from nomad_mj.video.layout import default_size


@dataclass(frozen=True)
class Record(TaskOptions):
    """Record an agent on video, MP4: the room, the sensors, what it perceives and decides."""

    agent: str = "planner"
    """Checkpoint, .npz, or name of an agent; `nomad-mj list` tells the names."""
    config: str = "faithful"
    """Parameters of an agent given by name, faithful or tuned; a checkpoint has its own."""
    starts: str = "1"
    """Number of episodes, from starts drawn from --seed, or a file of lines x,y[,heading],
    metres and radians."""
    seed: int = 0
    """Of the starts and of the sensors' noise."""
    max_decisions: int = 100
    """An episode is given up after so many decisions."""
    view: str = "side"
    """Camera: top, chase, overview, or side (chase and top beside each other)."""
    speed: float = 1.0
    """Video time runs so many times faster than simulated time."""
    fps: float = 30.0
    """Frames a second."""
    width: int = 0
    """Of a frame [pixels]; 0: what suits the view."""
    height: int = 0
    """Of a frame [pixels]; 0: what suits the view."""
    out: str = "renders"
    """Video to write, .mp4, or a folder for it (ROOM_ROBOT_AGENT.mp4)."""
    json: bool = False
    """Print one line of JSON last on standard output."""

    def run(self) -> int:
        """Record; return the exit code."""
        require_decisions(self.max_decisions)
        screen = console(json_wanted=self.json)
        with self.path_finding() as env, interruptible():
            agent = find_agent(self.agent, env.scene.robot.layout, find_config(self.config))
            name = f"{env.scene.arena.name}_{env.scene.robot.name}_{agent.name}"
            path = output_file(self.out, name, ".mp4")
            places: Sequence[Start] = choose_starts(env, self.starts, self.seed).tolist()
            with screen.status(f"recording {len(places)} episode(s)"):
                done = record(
                    env,
                    agent,
                    path,
                    starts=places,
                    seed=self.seed,
                    view=self.view,
                    speed=self.speed,
                    fps=self.fps,
                    size=self._size(),
                    max_decisions=self.max_decisions,
                )
        reached = sum(episode.reached for episode in done.episodes)
        screen.print(
            f"{done.path}: {done.frames} frames, {done.seconds:.1f} s; "
            f"the goal was reached in {reached} of {len(done.episodes)} episodes",
            soft_wrap=True,
        )
        if self.json:
            print_json(
                {
                    "path": str(Path(done.path)),
                    "frames": done.frames,
                    "seconds": done.seconds,
                    "episodes": len(done.episodes),
                    "reached": reached,
                }
            )
        return 0

    def _size(self) -> tuple[int, int]:
        """Return width and height of a frame [pixels]."""
        width, height = default_size(self.view)
        return self.width or width, self.height or height
