"""What the tests of the agents share: a small room, percepts, an agent with a known module."""

from collections.abc import Callable, Generator, Sequence
from pathlib import Path

import numpy as np
import pytest

import nomad_mj
from nomad_mj.envs import PathFinding
from nomad_mj.perception import Percept, SituationSpec, perceive
from nomad_mj.types import FloatArray, RangeRing, SensorLayout

BEARINGS = tuple((np.arange(16) * np.pi / 8).tolist())
SmallRoom = Callable[..., Path]
See = Callable[..., Percept]


@pytest.fixture(scope="session")
def layout() -> SensorLayout:
    """Return the sensors of a Nomad 200."""
    return SensorLayout(
        0.265,
        (
            RangeRing("sonar", BEARINGS, np.pi / 12, 0.15, 6.5),
            RangeRing("infrared", BEARINGS, np.pi / 12, 0.0, 0.6),
        ),
    )


@pytest.fixture(scope="session")
def see(layout: SensorLayout) -> See:
    """Return a maker of percepts: goal [m] and sonar readings [m], far where not given."""

    def make(
        goal: Sequence[float] | FloatArray = (3.0, 0.0),
        ranges: FloatArray | float = 6.5,
        spec: SituationSpec | None = None,
    ) -> Percept:
        sonar = np.broadcast_to(np.asarray(ranges, dtype=np.float64), (16,))
        readings = np.concatenate([sonar, np.minimum(sonar, 0.6)])
        return perceive(readings, 0.0, np.array(goal), layout, spec or SituationSpec())

    return make


@pytest.fixture
def here(see: See) -> Percept:
    """Return what is perceived in the open."""
    return see()


@pytest.fixture(scope="session")
def small_room(own_room: SmallRoom) -> Path:
    """Return a room with one box and three starts, learnt in seconds."""
    box = '<geom name="obstacle_1" type="box" size="1 0.3 0.5" pos="0 1 0.5"/>'
    starts = '<site name="start_1" pos="2 -1 0"/><site name="start_2" pos="-2.5 1 0"/>'
    goal = ('<site name="goal" pos="3 3 0"/>', '<site name="goal" pos="0 3 0"/>')
    first = ('pos="-3 -3 0"', 'pos="0 -0.5 0"')
    return own_room(box + starts, goal, first, name="small")


@pytest.fixture(scope="module")
def env(small_room: Path) -> Generator[PathFinding, None, None]:
    """Return path finding in the small room."""
    with nomad_mj.load("path_finding", room=small_room) as made:
        yield made
