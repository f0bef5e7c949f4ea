"""In a large room what rays cannot reach is hidden from them, and nothing else is different."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import nomad_mj
from nomad_mj.arenas import nearby
from nomad_mj.tasks import MotorEnvironment

SIDE = 30.0


@pytest.fixture(scope="module")
def field(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a room of 30 x 30 m with a post every two metres."""
    posts = "".join(
        f'<geom type="cylinder" size="0.15 0.45" pos="{x} {y} 0.45"/>'
        for x in np.arange(3.0, SIDE - 1, 2)
        for y in np.arange(3.0, SIDE - 1, 2)
    )
    walls = "".join(
        f'<geom type="box" size="{a} {b} 0.45" pos="{x} {y} 0.45"/>'
        for x, y, a, b in (
            (15, -0.1, 15.2, 0.1),
            (15, SIDE + 0.1, 15.2, 0.1),
            (-0.1, 15, 0.1, 15.2),
            (SIDE + 0.1, 15, 0.1, 15.2),
        )
    )
    path = tmp_path_factory.mktemp("field") / "field.xml"
    path.write_text(
        f"<mujoco><worldbody>{walls}{posts}<site name='goal' pos='28 28 0'/>"
        "<site name='start_0' pos='2 2 0'/></worldbody></mujoco>"
    )
    return path


def drive(env: MotorEnvironment, ticks: int) -> list[np.ndarray]:
    seen: list[np.ndarray] = []
    for tick in range(ticks):
        step = env.step((0.6, 0.3 if tick % 40 < 12 else 0.0, 0.1))
        seen.append(np.concatenate([np.ravel(value) for value in step.observation.values()]))
    return seen


def load(field: Path) -> MotorEnvironment:
    return nomad_mj.load("motor", field, task_kwargs={"random": 3})


def test_readings_are_the_same_to_the_bit(field: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with load(field) as env:
        env.reset(seed=1)
        hidden = drive(env, 150)
        assert (env.physics.model.ptr.geom_rgba[:, 3] == 0).sum() > 100
        assert (env.task.scene.model.geom_rgba[:, 3] > 0).all()  # pictures show all
    monkeypatch.setattr(nearby, "FEWEST", 10**6)
    with load(field) as env:
        env.reset(seed=1)
        np.testing.assert_array_equal(hidden, drive(env, 150))


def test_copies_begin_with_all_there_is(field: Path) -> None:
    with load(field) as env:
        env.reset(seed=1)
        drive(env, 20)
        for other in (env.physics.copy(), pickle.loads(pickle.dumps(env.physics))):
            assert (other.model.ptr.geom_rgba[:, 3] > 0).all()
            other.step(10)
            assert (other.model.ptr.geom_rgba[:, 3] == 0).sum() > 100
            other.free()


def test_small_rooms_are_left_alone() -> None:
    with nomad_mj.load("motor", "clutter") as env:
        env.reset(seed=0)
        drive(env, 5)
        assert env.physics.model.ptr is env.task.scene.model
