"""Of a large room what is near is simulated, and nothing that one can tell is different."""

import pickle
from pathlib import Path

import mujoco
import numpy as np
import pytest

import nomad_mj
from nomad_mj.arenas import nearby
from nomad_mj.robots import robot_geoms
from nomad_mj.tasks import InfraredEffects, MotorEnvironment
from nomad_mj.types import Pose

SIDE = 30.0


def drive(env: MotorEnvironment, ticks: int) -> list[np.ndarray]:
    seen: list[np.ndarray] = []
    for tick in range(ticks):
        step = env.step((0.6, 0.3 if tick % 40 < 12 else 0.0, 0.1))
        seen.append(np.concatenate([np.ravel(value) for value in step.observation.values()]))
    return seen


def load(wide_room: Path, **options: object) -> MotorEnvironment:
    return nomad_mj.load("motor", wide_room, task_kwargs={"random": 3, **options})


def test_readings_are_the_same_to_the_bit(wide_room: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    light = InfraredEffects(("sonar",))
    runs: list[list[np.ndarray]] = []
    for fewest in (nearby.FEWEST, 10**6):
        monkeypatch.setattr(nearby, "FEWEST", fewest)
        with load(wide_room, infrared=light) as env:
            assert (env.physics.model.ngeom < 80) == (fewest < 180)
            assert env.task.scene.model.ngeom > 180
            seen: list[np.ndarray] = []
            for start in ((2.0, 2.0, 0.0), (25.0, 24.0, 2.0), (14.0, 2.0, 1.0)):
                first = env.reset(start=start)
                seen.append(np.concatenate([np.ravel(v) for v in first.observation.values()]))
                seen += drive(env, 60)
            runs.append(seen)
    np.testing.assert_array_equal(runs[0], runs[1])


def test_the_robot_runs_into_what_was_far_away(wide_room: Path) -> None:
    with load(wide_room) as env:
        env.reset(start=(2.0, 2.0, 0.0))
        for _ in range(1000):  # along a lane to its end
            env.step((0.6, 0.0, 0.0))
        assert env.physics.bumpers().any()
        assert SIDE - 0.4 < env.physics.pose().x < SIDE - 0.2
        env.reset(start=(20.0, 15.0, 0.0))
        for _ in range(40):
            env.step((0.6, 0.0, 0.0))
        assert env.physics.bumpers().any()
        assert 20.5 < env.physics.pose().x < 20.65  # the post's surface is at 20.85


def test_copies_go_on_where_they_are(wide_room: Path) -> None:
    with load(wide_room) as env:
        env.reset(seed=1)
        drive(env, 20)
        others = [
            env.physics.copy(),
            env.physics.copy(share_model=True),
            pickle.loads(pickle.dumps(env.physics)),
        ]
        env.physics.step(10)
        here = env.physics.cone_ranges()
        for other in others:
            other.step(10)
            np.testing.assert_array_equal(other.cone_ranges(), here)
            other.place(Pose(26.0, 26.0, 0.0))
            other.forward()
            other.free()
        env.physics.step(10)
        assert np.abs(env.physics.cone_ranges() - here).max() < 0.1  # nobody changed its room


def test_pictures_show_all(wide_room: Path) -> None:
    with load(wide_room) as env:
        env.reset(start=(2.0, 2.0, 0.0))
        for place in (Pose(2.0, 2.0, 0.0), Pose(26.0, 26.0, 0.0)):
            env.physics.place(place)
            labels = env.physics.render(240, 240, camera_id="room/top", segmentation=True)
            drawn = np.unique(labels[labels[..., 1] == mujoco.mjtObj.mjOBJ_GEOM][:, 0])
            assert len(drawn) > 170
            robot = robot_geoms(env.task.scene.model)
            rows, columns = np.nonzero(np.isin(labels[..., 0], robot))
            assert columns.mean() / 240 == pytest.approx((place.x + 1.5) / 33, abs=0.02)
            assert rows.mean() / 240 == pytest.approx(1 - (place.y + 1.5) / 33, abs=0.02)


def test_small_rooms_are_left_alone() -> None:
    with nomad_mj.load("motor", "clutter") as env:
        env.reset(seed=0)
        drive(env, 5)
        assert env.physics.model.ptr is env.task.scene.model
