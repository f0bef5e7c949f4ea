"""Many robots at once against each by itself: what the tests of the batch share."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import dm_env
import numpy as np

from nomad_mj import BatchMotor, BatchPathFinding, MotorEnvironment, PathFinding, load
from nomad_mj.batch import BatchTimeStep
from nomad_mj.types import FloatArray

Env = MotorEnvironment | PathFinding
BatchEnv = BatchMotor | BatchPathFinding


def singles(
    task: str,
    rooms: Sequence[str | Path],
    robot: str | Path,
    options: dict[str, Any],
    goals: Sequence[Any] | None = None,
    **environment: Any,
) -> list[Env]:
    """Return the single environments that the worlds of a batch with seed 0 should be."""
    make: Any = load  # of a task that is not known before
    return [
        make(
            task,
            room,
            robot,
            {**options, "random": world},
            environment,
            goal=None if goals is None else goals[world],
        )
        for world, room in enumerate(rooms)
    ]


def drawn_actions(env: BatchEnv, steps: int, seed: int = 0) -> Iterator[FloatArray]:
    spec = env.action_spec()
    rng = np.random.default_rng(seed)
    for _ in range(steps):
        yield rng.uniform(spec.minimum, spec.maximum)


def check_same(many: BatchTimeStep, ones: Sequence[dm_env.TimeStep], when: object) -> None:
    """Fail unless every bit of every world is that of the single environments."""
    for world, one in enumerate(ones):
        told = many.world(world)
        where = f"{when}, world {world}"
        assert told[:3] == one[:3], where
        assert list(told.observation) == list(one.observation)
        for name, value in one.observation.items():
            mine = np.asarray(told.observation[name])
            assert mine.dtype == np.asarray(value).dtype, name
            assert mine.tobytes() == np.asarray(value).tobytes(), f"{where}: {name} {mine} {value}"
