"""Work for the pool that is over at once, does harm, or leaves a mark of having been done."""

import os
import signal
import time
from pathlib import Path

import numpy as np
from nomad_agents.experiments.experiment import LEARNER
from nomad_agents.studies.runs import Result, Run

from nomad_mj.errors import ConfigError


def runs(count: int) -> list[Run]:
    return [
        Run("known", "a case", LEARNER, "tuned", "paper_room", "nomad200", n) for n in range(count)
    ]


def draw(run: Run, folder: Path) -> Result:
    """Draw a number, and note in the folder that it was done."""
    with (folder / "done.txt").open("a") as file:
        file.write(f"{run.seed}\n")
    drawn = np.random.default_rng(run.seed).normal(size=2)
    row = {"first": float(drawn[0]), "none": float("nan")}
    return Result(run, row, [{"x": float(drawn[1])}], [{"pass": 1}], {"ways": [[1, 2]]})


def draw_slowly(run: Run, folder: Path) -> Result:
    """Do the same and take some time."""
    time.sleep(0.3)
    return draw(run, folder)


def fail_at_two(run: Run, folder: Path) -> Result:
    if run.seed == 2:
        raise ConfigError("two: must be anything else")
    return draw(run, folder)


def die_at_two(run: Run, folder: Path) -> Result:
    if run.seed == 2:
        os.kill(os.getpid(), signal.SIGKILL)
    return draw(run, folder)
