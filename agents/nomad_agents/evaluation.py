"""Evaluation: a greedy agent on starts it may never have seen, in the field's metrics."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from nomad_agents.agent import Agent
from nomad_agents.episode import Episode, run_episode
from nomad_agents.training import stream
from nomad_mj.arenas import Geodesic
from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError, StartError
from nomad_mj.tasks import Start, resolve_start
from nomad_mj.types import FloatArray

START_CLEARANCE = 0.12  # [m] between the robot's perimeter and everything
GOAL_DISTANCE = 1.2  # [m] a start keeps from the goal
_PLACES, _EPISODE = 10, 11  # kinds of streams; training has the others


class Trial(NamedTuple):
    """An evaluated episode.

    Attributes
    ----------
    start : array (3,)
        x, y [m] and heading [rad].
    episode : Episode
        What it took.
    track : array (n, 2)
        True positions at every control step [m].
    shortest : float
        Length of the shortest path of a disc of the robot's radius [m], among what stands and to
        where the goal is at the start; inf if there is none.
    """

    start: FloatArray
    episode: Episode
    track: FloatArray
    shortest: float

    @property
    def length(self) -> float:
        """Length of the true way [m]."""
        return float(np.hypot(*np.diff(self.track, axis=0).T).sum())


def draw_starts(env: PathFinding, count: int, seed: int) -> FloatArray:
    """Return `count` starts (n, 3), uniform over the floor from which the goal can be reached.

    Raises
    ------
    ConfigError
        A count below 1 or a seed below 0.
    StartError
        The room has no such place.
    """
    if count < 1 or seed < 0:
        raise ConfigError(f"starts {count}, seed {seed}: must be at least 1 and 0")
    rng = np.random.default_rng(stream(seed, _PLACES))
    scene = env.scene
    places = scene.plan.sample_free(
        count, rng, scene.robot.layout.radius, START_CLEARANCE, scene.arena.goal, GOAL_DISTANCE
    )
    return np.column_stack([places, rng.uniform(-np.pi, np.pi, count)])


def read_starts(path: Path) -> FloatArray:
    """Return the starts (n, 3) of a file of lines ``x,y`` or ``x,y,heading``.

    Metres and radians; empty lines and what follows a # are skipped.

    Raises
    ------
    StartError
        No such file, or a line that is neither; a heading beyond a turn, as degrees are.
    """
    try:
        lines = path.expanduser().read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise StartError(f"starts file {str(path)!r} is not text") from None
    except (OSError, RuntimeError) as error:  # RuntimeError: a home that there is not
        reason = getattr(error, "strerror", None) or error
        raise StartError(f"starts file {str(path)!r} cannot be read: {reason}") from None
    starts: list[list[float]] = []
    for number, line in enumerate(lines, 1):
        text = line.partition("#")[0].strip()
        if not text:
            continue
        try:
            values = [float(part) for part in text.split(",")]
        except ValueError:
            values = []
        if len(values) not in (2, 3) or not np.isfinite(values).all():
            raise StartError(
                f"starts file {str(path)!r}, line {number}: {text[:40]!r} is not x,y or x,y,heading"
            )
        if len(values) == 3 and abs(values[2]) > 2 * math.pi:
            raise StartError(
                f"starts file {str(path)!r}, line {number}: heading {values[2]:g} is no angle in "
                "radians"
            )
        starts.append([*values, 0.0][:3])
    if not starts:
        raise StartError(f"starts file {str(path)!r} holds no start; lines are x,y[,heading]")
    return np.array(starts)


def run_trial(
    env: PathFinding,
    agent: Agent,
    start: Start,
    seed: np.random.SeedSequence,
    max_decisions: int,
    geodesic: Geodesic,
) -> Trial:
    """Run one greedy episode and measure it by the truth."""
    track: list[tuple[float, float]] = []
    before = env.on_control_step  # of whoever looks on, too

    def look_on() -> None:
        track.append(env.physics.pose()[:2])
        if before is not None:
            before()

    env.on_control_step = look_on
    try:
        episode = run_episode(env, agent, seed=seed, start=start, max_decisions=max_decisions)
    finally:
        env.on_control_step = before
    pose = env.motor.task.start_pose
    points = np.array([pose[:2], *track])
    return Trial(np.array(pose), episode, points, float(geodesic.length(points[:1])[0]))


def evaluate(
    env: PathFinding,
    agent: Agent,
    starts: FloatArray,
    seed: int,
    max_decisions: int = 100,
    after_trial: Callable[[Trial], None] | None = None,
) -> list[Trial]:
    """Run a greedy agent from every start (n, 3).

    Raises
    ------
    ConfigError
        A seed below 0, or no decisions.
    StartError
        A start inside an obstacle or cut off from the goal; nothing has been run then.
    """
    if seed < 0 or max_decisions < 1:
        raise ConfigError(f"seed {seed}, max_decisions {max_decisions}: must be at least 0 and 1")
    for start in starts:
        resolve_start(env.scene, start, np.random.default_rng(0))
    scene = env.scene
    geodesic = Geodesic(scene.plan, scene.arena.goal, scene.robot.layout.radius)
    trials: list[Trial] = []
    for number, start in enumerate(starts):
        seeds = stream(seed, _EPISODE, number)
        trials.append(run_trial(env, agent, start, seeds, max_decisions, geodesic))
        if after_trial is not None:
            after_trial(trials[-1])
    return trials


def path_efficiency(reached: bool, shortest: float, length: float) -> float:
    """Return S L / max(P, L), the term of SPL (Anderson et al. 2018), in [0, 1].

    A start at the goal (L = 0) counts as fully efficient if the robot did not move, a goal that
    cannot be reached as 0.
    """
    if not reached or not np.isfinite(shortest):
        return 0.0
    longest = max(length, shortest)
    return shortest / longest if longest > 0 else 1.0


def summarise(env: PathFinding, trials: list[Trial]) -> dict[str, float | int]:
    """Return the metrics of `nomad-mj evaluate --json`; those of no episode are NaN.

    `min_clearance_m` is that to what stands; moving obstacles are not in it.
    """
    episodes = [trial.episode for trial in trials]
    reached = [t for t in trials if t.episode.reached]
    ratios = [t.length / t.shortest for t in reached if 0 < t.shortest < np.inf]
    scene = env.scene
    radius = scene.robot.layout.radius
    clearance = [float(scene.plan.clearance(t.track, radius).min()) for t in trials]
    return {
        "episodes": len(trials),
        "success_rate": _mean([e.reached for e in episodes]),
        "strict_success_rate": _mean([e.strict for e in episodes]),
        "spl": _mean([path_efficiency(t.episode.reached, t.shortest, t.length) for t in trials]),
        "path_ratio_median": float(np.median(ratios)) if ratios else float("nan"),
        "min_clearance_m": min(clearance, default=float("nan")),
        "virtual_collisions": sum(e.virtual_collisions for e in episodes),
        "bumper_contacts": sum(e.bumper_contacts for e in episodes),
        "no_match_rate": _mean([e.unmatched > 0 for e in episodes]),
        "mean_time_s": _mean([t.episode.duration for t in reached]),
    }


def _mean(values: list[bool] | list[float]) -> float:
    return float(np.mean(values)) if values else float("nan")
