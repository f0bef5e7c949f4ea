"""What ``nomad-mj train`` does with sac, td3 and ppo."""

import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

import gymnasium
from rich.console import Console

from nomad_agents.cli.progress import DeepProgress
from nomad_agents.deep import DeepAgent, DeepSettings
from nomad_agents.deep.file import DeepFile, save_deep
from nomad_agents.deep.training import DeepTraining, train_deep
from nomad_agents.episode import run_episode
from nomad_agents.training import stream
from nomad_mj.envs import PathFinding

SAVE_EVERY = 1000  # decisions
_TEST, _TEST_DECISIONS = 40, 50


def run_deep_training(
    env: "gymnasium.Env[Any, Any]",
    test: PathFinding,
    settings: DeepSettings,
    seed: int,
    decisions: int,
    path: Path,
    screen: Console,
    conditions: dict[str, Any],
    log_folder: Path | None,
) -> dict[str, Any]:
    """Train with a progress bar, test on all starts of the room, and return the report.

    Every so many decisions `path` is written anew, so that what an interrupted training has
    learnt is not lost, though it cannot go on from there.

    Parameters
    ----------
    env, test
        To learn in, and to test in; of the same room and robot.
    settings, seed, decisions, log_folder
        As of `train_deep`.
    path : Path
        The file to write.
    screen : Console
        Where the bar is shown.
    conditions : dict
        As of `TaskOptions.conditions`.
    """
    training, began = DeepTraining(), time.perf_counter()
    names = test.scene.arena.name, test.scene.robot.name

    def save(agent: DeepAgent, *_: object) -> None:
        state = {**asdict(training), "seed": seed}
        save_deep(path, DeepFile(agent, *names, state, conditions))

    with DeepProgress(screen, decisions) as progress:
        agent = train_deep(
            settings,
            env,
            seed,
            decisions,
            SAVE_EVERY,
            save,
            training=training,
            after_decision=progress.show,
            log_folder=log_folder,
        )
    wall_s = time.perf_counter() - began
    with screen.status("testing all starts"):
        solved = _solved(test, agent, seed)
    report = {"solved": solved, "starts": len(test.scene.arena.starts), **asdict(training)}
    return {**report, "wall_s": round(wall_s, 3), "sim_s": round(training.sim_s, 3)}


def _solved(test: PathFinding, agent: DeepAgent, seed: int) -> int:
    """Return from how many starts of the room an agent finds the goal."""
    episodes = (
        run_episode(
            test,
            agent,
            seed=stream(seed, _TEST, start),
            start=start,
            max_decisions=_TEST_DECISIONS,
        )
        for start in range(len(test.scene.arena.starts))
    )
    return sum(episode.reached for episode in episodes)
