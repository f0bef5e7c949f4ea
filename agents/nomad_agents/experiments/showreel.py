"""The video of an experiment: its showcase, short enough to be looked at and small enough to mail.

It is filmed once: a note beside it says of what study and which versions, and how it went.
"""

import copy
import json
import math
import subprocess
from collections.abc import Sequence
from dataclasses import asdict
from importlib.metadata import version
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np

from nomad_agents.checkpoint import write_atomically
from nomad_agents.episode import Episode, run_episode
from nomad_agents.experiments.experiment import Experiment, Showcase, Study
from nomad_agents.experiments.report.section import NoVideo, Video
from nomad_agents.recording import PAUSES, record
from nomad_agents.studies.runs import PACKAGES
from nomad_agents.training import stream
from nomad_mj.errors import OutputError, RenderError

VIEW, SIZE, FPS = "overview", (720, 540), 24.0  # legible on a phone; half a megabyte in 30 s
LONGEST = 30.0  # [s]
_SLOWEST = 3  # times real time
_RESTING = 1 / 3  # of the video, at most, between episodes
_SEED, _EXPLORE = 0, 22  # of the video; a stream of random numbers
_GONE_BY = 2 / 3  # of the longest episode, when the poster is taken: most of the path is drawn


def film(
    experiment: Experiment, study: Study, folder: Path, path: Path, *, longest: float = LONGEST
) -> Video | NoVideo:
    """Return the video of an experiment, made now unless it is newer than all its results.

    Parameters
    ----------
    experiment, study
        What to show.
    folder : Path
        Where the results of its runs are.
    path : Path
        The video, ``.mp4``; a poster ``.jpg`` and a note ``.json`` are written beside it.
    longest : float
        About how long it may be [s]: long episodes are played faster.

    Returns
    -------
    Video or NoVideo
        The latter where no OpenGL works.

    Raises
    ------
    OutputError
        The video cannot be written.
    """
    about = _about(experiment, study)
    results = [folder / run.file_name for run in experiment.runs(study)]
    held = _on_file(path, about, results)
    if held is not None:
        return held
    path.with_suffix(".json").unlink(missing_ok=True)  # it would vouch for half a new video
    try:
        showcase = experiment.showcase(study, folder)
        with showcase.env:
            caption = _shoot(showcase, experiment.title, path, longest)
    except RenderError as error:
        return NoVideo(str(error))
    note = json.dumps({"about": about, "caption": caption}, indent=1).encode()
    write_atomically(path.with_suffix(".json"), lambda file: file.write(note))
    return Video(path, path.with_suffix(".jpg"), caption)


def _about(experiment: Experiment, study: Study) -> dict[str, Any]:
    packages = {name: version(name) for name in PACKAGES}
    return {"experiment": experiment.name, **asdict(study), "packages": packages}


def _on_file(path: Path, about: dict[str, Any], results: Sequence[Path]) -> Video | None:
    """Return the video that is there, if it shows just this and is newer than the results."""
    poster, note = path.with_suffix(".jpg"), path.with_suffix(".json")
    if not all(file.is_file() for file in (path, poster, note)):
        return None
    newest = max((file.stat().st_mtime_ns for file in results if file.exists()), default=0)
    if path.stat().st_mtime_ns < newest:
        return None
    try:
        held = json.loads(note.read_text(encoding="utf-8"))
        return Video(path, poster, str(held["caption"])) if held["about"] == about else None
    except (OSError, ValueError, KeyError, TypeError):
        return None  # a note that nobody can read says nothing


def _shoot(showcase: Showcase, title: str, path: Path, longest: float) -> str:
    """Record a showcase and its poster; return the caption."""
    count = len(showcase.starts)
    share = min(_RESTING * longest / (count * sum(PAUSES)), 1.0)
    pauses = (PAUSES[0] * share, PAUSES[1] * share)
    driving = sum(episode.duration for episode in _rehearse(showcase))
    speed = max(math.ceil(driving / (longest - count * sum(pauses))), _SLOWEST)
    done = record(
        showcase.env,
        showcase.agent,
        path,
        starts=showcase.starts,
        seed=_SEED,
        view=VIEW,
        speed=speed,
        fps=FPS,
        size=SIZE,
        explore=_exploration(showcase),
        title=title,
        subtitle=showcase.subtitle,
        pauses=pauses,
    )
    _take_poster(path, _telling_moment(done.episodes, speed, pauses))
    return _caption(showcase, done.episodes, speed)


def _exploration(showcase: Showcase) -> np.random.Generator | None:
    return np.random.default_rng(stream(_SEED, _EXPLORE)) if showcase.learning else None


def _rehearse(showcase: Showcase) -> list[Episode]:
    """Return the episodes as `record` will have them; the agent is left as it is."""
    agent, explore = copy.deepcopy(showcase.agent), _exploration(showcase)
    seeds = np.random.SeedSequence(_SEED).spawn(len(showcase.starts))
    return [
        run_episode(showcase.env, agent, seed=seed, start=start, explore=explore)
        for seed, start in zip(seeds, showcase.starts, strict=True)
    ]


def _telling_moment(
    episodes: Sequence[Episode], speed: float, pauses: tuple[float, float]
) -> float:
    """Return when in the video [s] to look: in its longest episode."""
    longest = max(range(len(episodes)), key=lambda number: episodes[number].duration)
    before = sum(episode.duration / speed + sum(pauses) for episode in episodes[:longest])
    return before + pauses[0] + _GONE_BY * episodes[longest].duration / speed


def _take_poster(path: Path, time: float) -> None:
    """Write the frame of a video at a time [s] beside it.

    Raises
    ------
    OutputError
        ffmpeg cannot read it, or the picture cannot be written.
    """
    command = [
        imageio_ffmpeg.get_ffmpeg_exe(),
        "-v",
        "error",
        "-ss",
        f"{time:.3f}",
        "-i",
        str(path),
    ]
    command += ["-frames:v", "1", "-q:v", "3", "-f", "image2pipe", "-c:v", "mjpeg", "-"]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
    if done.returncode or not done.stdout:
        reason = " ".join(done.stderr.decode(errors="replace").split())
        raise OutputError(f"no frame of {str(path)!r} at {time:.1f} s: {reason}")
    write_atomically(path.with_suffix(".jpg"), lambda file: file.write(done.stdout))


def _caption(showcase: Showcase, episodes: Sequence[Episode], speed: float) -> str:
    """Return what the video shows and how it went."""
    count, reached = len(episodes), sum(episode.reached for episode in episodes)
    case = f"{showcase.subtitle[:1].upper()}{showcase.subtitle[1:]}. " if showcase.subtitle else ""
    agent = showcase.agent.name.replace("_", " ")
    doing = f"The {agent} while it learns" if showcase.learning else f"The {agent}"
    if count == 1:
        outcome = "the goal is reached" if reached else "the goal is not reached"
        return f"{case}{doing}, from one start: {outcome}. {speed:g} times real time."
    outcome = f"the goal is reached in {reached} of {count} episodes"
    return f"{case}{doing}, from {count} starts: {outcome}. {speed:g} times real time."
