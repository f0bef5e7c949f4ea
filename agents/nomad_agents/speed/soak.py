"""A long run in one process: it must neither grow nor make the engine warn."""

import math
import resource
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

import nomad_mj
from nomad_mj.errors import ConfigError
from nomad_mj.scene import CONTROL_TIMESTEP

Progress = Callable[[float], None]
_WARM_UP = 0.05  # of the run, in which caches fill


@dataclass(frozen=True)
class Soaked:
    """What a long run came to.

    Attributes
    ----------
    resets : int
        Episodes begun.
    sim_hours : float
        Simulated time of all robots together [h].
    growth : float
        Share by which the memory has grown since it was warm.
    warnings : int
        Lines in which the engine warned.
    """

    resets: int
    sim_hours: float
    growth: float
    warnings: int


def memory() -> float:
    """Return the memory that this process holds now [bytes]; its peak where no /proc tells."""
    status = Path("/proc/self/statm")
    if status.is_file():
        return float(status.read_text().split()[1]) * resource.getpagesize()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(peak) * (1 if sys.platform == "darwin" else 1024)


class _Warnings:
    """Counts what the engine warns of while this is open."""

    def __enter__(self) -> "list[str]":
        self._said: list[str] = []
        self._before = mujoco.get_mju_user_warning()
        mujoco.set_mju_user_warning(self._said.append)
        return self._said

    def __exit__(self, *_: object) -> None:
        mujoco.set_mju_user_warning(self._before)


def soak(
    room: str, resets: int, sim_hours: float, robots: int = 1, progress: Progress | None = None
) -> Soaked:
    """Drive with random commands through episodes of equal length, and watch the memory.

    Parameters
    ----------
    room : str
        Where.
    resets : int
        Episodes, of all robots together.
    sim_hours : float
        Simulated time, likewise [h].
    robots : int
        1: the single motor environment; more: a batch of so many.
    progress : callable, optional
        Told how far it is, from 0 to 1.

    Raises
    ------
    ConfigError
        Fewer than two episodes for each robot, or a time without end.
    """
    if not sim_hours < math.inf:
        raise ConfigError(f"hours {sim_hours}: must be finite")
    episodes = round(resets / robots)
    if episodes < 2:  # the first fills the caches
        raise ConfigError(f"resets {resets}: must be {2 * robots} or more, two for each robot")
    steps = max(round(sim_hours * 3600 / CONTROL_TIMESTEP / (episodes * robots)), 1)
    rng = np.random.default_rng(0)
    options = {"random": 0, "ends_at_goal": False}
    env = (
        nomad_mj.load("motor", room, task_kwargs=options)
        if robots == 1
        else nomad_mj.load_batch("motor", robots, room, task_kwargs=options)
    )
    spec = env.action_spec()
    warm, warm_at = 0.0, max(round(episodes * _WARM_UP), 1)
    with _Warnings() as said:
        for episode in range(episodes):
            if episode == warm_at:
                warm = memory()
            env.reset()
            # Slow enough that some touch nothing, fast enough that others do.
            command = rng.uniform(0.5 * spec.minimum, 0.5 * spec.maximum)
            for _ in range(steps):
                env.step(command)
            if progress is not None:
                progress((episode + 1) / episodes)
        grown = memory() / warm - 1.0 if warm else 0.0
    env.close()
    hours = episodes * robots * steps * CONTROL_TIMESTEP / 3600
    return Soaked(episodes * robots, hours, grown, len(said))
