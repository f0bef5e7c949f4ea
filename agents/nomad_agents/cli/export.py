"""``nomad-mj export``."""

import re
from contextlib import closing
from dataclasses import dataclass
from typing import Any, Literal

import gymnasium

from nomad_agents.cli.common import console, interruptible, print_json
from nomad_agents.cli.evaluate import choose_starts, require_decisions
from nomad_agents.cli.progress import trial_progress
from nomad_agents.collecting import collect, task_of
from nomad_agents.dataset import datasets_root, require_new, write_dataset
from nomad_agents.extras import need
from nomad_agents.registry import find_agent, find_config
from nomad_agents.task_options import TaskOptions
from nomad_mj.assets import find_robot, find_room
from nomad_mj.gym.registration import PATH_FINDING


@dataclass(frozen=True)
class Export(TaskOptions):
    """Let an agent drive and write its episodes as a Minari dataset, for offline learning."""

    agent: str = "planner"
    """Checkpoint, .npz, or name of an agent."""
    config: str = "faithful"
    """Parameters of an agent given by name, faithful or tuned; a checkpoint has its own."""
    starts: str = "20"
    """Number of episodes, from starts drawn from --seed, or a file of lines x,y[,heading],
    metres and radians."""
    seed: int = 0
    """Of the starts and of the sensors' noise."""
    max_decisions: int = 100
    """An episode is given up after so many decisions."""
    observation: Literal["situation", "ranges", "dict"] = "dict"
    """What the dataset's observations are."""
    dataset: str = ""
    """Id of the dataset, such as mine/clutter-v0; by default nomad_mj/ROOM-ROBOT-AGENT-v0."""
    out: str = ""
    """Folder of all datasets; by default $MINARI_DATASETS_PATH or ~/.minari/datasets."""
    json: bool = False
    """Print one line of JSON last on standard output."""

    def run(self) -> int:
        """Export; return the exit code."""
        require_decisions(self.max_decisions)
        need("minari", "minari", "export")
        need("h5py", "minari", "export")
        screen = console(json_wanted=self.json)
        env = gymnasium.make(
            PATH_FINDING,
            max_episode_steps=self.max_decisions,
            observation=self.observation,
            **self._found_anywhere(),
        )
        with closing(env), interruptible():
            task = task_of(env)
            robot, arena = task.scene.robot, task.scene.arena
            agent = find_agent(self.agent, robot.layout, find_config(self.config))
            usual = f"{arena.name}-{robot.name}-{agent.name}"
            name = self.dataset or f"nomad_mj/{re.sub(r'[^A-Za-z0-9_-]', '_', usual)}-v0"
            root = datasets_root(self.out)
            require_new(root, name)
            starts = choose_starts(task, self.starts, self.seed).tolist()
            with trial_progress(screen) as progress:
                bar = progress.add_task(f"driving by {agent.name}", total=len(starts))
                episodes = collect(env, agent, starts, self.seed, lambda _: progress.advance(bar))
            told = f"{agent.name} drives a {robot.name} in {arena.name}"
            path = write_dataset(root, name, env, episodes, agent=agent.name, description=told)
        steps = sum(len(episode.actions) for episode in episodes)
        reached = sum(episode.terminated for episode in episodes)
        screen.print(
            f"{path}: {len(episodes)} episodes, {steps} steps; the goal was reached in {reached}; "
            f"minari.load_dataset({name!r})",
            soft_wrap=True,
        )
        if self.json:
            print_json(
                {
                    "dataset": name,
                    "path": str(path),
                    "episodes": len(episodes),
                    "steps": steps,
                    "reached": reached,
                }
            )
        return 0

    def _found_anywhere(self) -> dict[str, Any]:
        """Return the environment's options; files by their whole path, as datasets travel."""
        options = self.load_options()
        for kind, find in (("room", find_room), ("robot", find_robot)):
            path = find(options[kind])
            if options[kind] != path.stem:
                options[kind] = str(path.absolute())
        return options
