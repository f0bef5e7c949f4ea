"""Record an agent on video: what it perceives, decides and does."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from nomad_agents.agent import Agent, Decision
from nomad_agents.episode import Episode, Turn, Watcher, run_episode
from nomad_mj.envs import PathFinding
from nomad_mj.motion import displacement
from nomad_mj.tasks import Start
from nomad_mj.video import BLUE, GREY, ORANGE, Caption, EpisodeRecorder

PAUSES = (1.2, 1.6)  # [s of the video] before and after an episode
_COLOURS = {"reacted": BLUE, "planned": ORANGE, "none": GREY}


class Recording(NamedTuple):
    """What was recorded: the video, its length in frames and in seconds, and the episodes."""

    path: Path
    frames: int
    seconds: float
    episodes: tuple[Episode, ...]


def _caption(number: int, decision: Decision, z: float | None) -> Caption:
    fields = [("decision", str(number))]
    if decision.category >= 0:
        fields.append(("category", str(decision.category)))
    if z is not None:
        fields.append(("last z", f"{round(z, 2) + 0.0:.2f}"))  # never "-0.00"
    kind = "nearest" if decision.kind == "reacted" and decision.unmatched else decision.kind
    return Caption(kind, _COLOURS.get(kind, GREY), tuple(fields))


def _narrator(
    recorder: EpisodeRecorder,
    env: PathFinding,
    agent: Agent,
    lines: tuple[str, str],
    pause: float,
) -> Watcher:
    """Return a watcher that tells the recorder what the agent is about in one episode."""
    number, z = 0, None

    def watch(turn: Turn) -> None:
        nonlocal number, z
        percept, decision, after = turn
        if after is not None:
            z = float(after.reward)
            recorder.caption(_caption(number, decision, z))
            return
        if number == 0:
            recorder.start_episode(*lines, pause)
        number += 1
        recorder.annotate(
            percept.grid,
            displacement(decision.action, percept.goal, env.config.action),
            _caption(number, decision, z),
            cell=agent.situation.grid.resolution,
        )

    return watch


def _outcome(episode: Episode) -> tuple[str, str]:
    """Return what came of an episode, and what it took."""
    reached = "goal reached" if episode.reached else "goal not reached"
    took = f"{episode.decisions} decisions, {episode.driven:.1f} m, {episode.duration:.0f} s"
    return reached, took


def record(
    env: PathFinding,
    agent: Agent,
    path: str | Path,
    *,
    starts: Sequence[Start],
    seed: int = 0,
    view: str = "side",
    speed: float = 1.0,
    fps: float = 30.0,
    size: tuple[int, int] | None = None,
    max_decisions: int = 100,
    explore: np.random.Generator | None = None,
    title: str = "",
    subtitle: str = "",
    pauses: tuple[float, float] = PAUSES,
) -> Recording:
    """Record one episode from each start and return what they took.

    Parameters
    ----------
    env, agent
        Of the same robot.
    path : str or Path
        The video, ``.mp4``; it appears when all episodes are over.
    starts : sequence
        As of `PathFinding.reset`.
    seed : int
        Of the environment.
    view, speed, fps, size, max_decisions, explore
        As of `EpisodeRecorder` and `run_episode`.
    title, subtitle : str
        Shown before each episode, the number of the start added; agent and room if empty.
    pauses : (float, float)
        For how long to show that, and the outcome of each episode [s of the video].

    Raises
    ------
    NomadError
        An option, a start or a path that is wrong; no OpenGL.
    """
    episodes, count = list[Episode](), len(starts)
    title = title or f"{agent.name} in {env.scene.arena.name}".replace("_", " ")
    with EpisodeRecorder(env, path, view=view, size=size, fps=fps, speed=speed) as recorder:
        for i, stream in enumerate(np.random.SeedSequence(seed).spawn(count)):
            numbered = f"start {i + 1} of {count}" if count > 1 else ""
            lines = title, ", ".join(filter(None, (subtitle, numbered)))
            watch = _narrator(recorder, env, agent, lines, pauses[0])
            episode = run_episode(
                env,
                agent,
                seed=stream,
                start=starts[i],
                explore=explore,
                max_decisions=max_decisions,
                watch=watch,
            )
            episodes.append(episode)
            recorder.hold(pauses[1], *_outcome(episode))
        frames = recorder.frames
    return Recording(Path(path), frames, frames / fps, tuple(episodes))
