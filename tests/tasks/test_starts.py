"""A start is honoured as given, or refused in one line."""

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nomad_mj import MotorEnvironment, NomadError, load
from nomad_mj.errors import StartError, UnknownNameError
from nomad_mj.scene import Scene, build_scene
from nomad_mj.tasks import resolve_start

SCENE = build_scene("paper_room", "nomad200")


@pytest.fixture(scope="module")
def env() -> Iterator[MotorEnvironment]:
    made = load("motor")
    yield made
    made.close()


def resolve(start: Any, seed: int = 0, scene: Scene = SCENE) -> Any:
    return resolve_start(scene, start, np.random.default_rng(seed))


@given(st.floats(0.3, 9.7), st.floats(0.3, 9.7), st.floats(-7, 7))
def test_a_free_pose_is_taken_to_the_bit_and_another_is_refused(
    x: float, y: float, heading: float
) -> None:
    clearance = float(SCENE.plan.clearance(np.array([x, y]), 0.265))
    if clearance > 1e-6:
        assert resolve((x, y, heading)) == (x, y, heading)
        assert resolve([x, y]) == (x, y, 0.0)
        assert resolve(np.array([x, y])) == (x, y, 0.0)
    elif clearance < -1e-6:
        with pytest.raises(StartError, match=r"inside '(wall|obstacle)_\w+'"):
            resolve((x, y, heading))


@given(st.integers(0, 49))
def test_starts_of_the_room_go_by_number_or_name(number: int) -> None:
    wanted = tuple(SCENE.arena.starts[number].tolist())
    assert resolve(number) == resolve(np.int64(number)) == wanted
    assert resolve(SCENE.arena.start_names[number]) == wanted


def test_none_is_one_of_the_rooms_at_random_and_all_have_their_turn() -> None:
    drawn = {resolve(None, seed) for seed in range(600)}
    assert drawn == {tuple(pose) for pose in SCENE.arena.starts.tolist()}
    assert resolve(None, 7) == resolve(None, 7)


REFUSED: dict[str, tuple[Any, str]] = {
    "in a box": ((4.8, 5.0), r"^start \(4\.8, 5\) is .*inside 'obstacle_\w+' .* radius"),
    "too near a wall": ((0.2, 5.0), r"0\.0\d m inside 'wall_west' .*the floor is 0 to 10 m"),
    "far outside": ((50.0, 5.0), r"cut off from the goal .*the floor is 0 to 10 m"),
    "one number": ((1.0,), r"must be \(x, y\) or \(x, y, heading\)"),
    "four numbers": ((1.0, 2.0, 3.0, 4.0), "must be"),
    "nothing": ((), "must be"),
    "a number": (1.5, r"^start 1\.5: must be"),
    "nan": ((math.nan, 1.0), "must be"),
    "infinite heading": ((1.0, 1.0, math.inf), "must be"),
    "letters": (("a", "b"), "must be"),
    "ragged": ([[1.0], [1.0, 2.0]], "must be"),
    "matrix": (np.zeros((3, 3)), "must be"),
    "mapping": ({"x": 1}, "must be"),
    "number too high": (50, r"^start 50: the room's are numbered 0 to 49$"),
    "negative number": (-1, r"^start -1: the room's are numbered 0 to 49$"),
}


@pytest.mark.parametrize(("start", "message"), REFUSED.values(), ids=REFUSED.keys())
def test_a_start_that_cannot_be_is_refused_in_one_line(
    env: MotorEnvironment, start: Any, message: str
) -> None:
    before = env.reset(seed=1, start=3).observation
    with pytest.raises(StartError, match=message) as caught:
        env.reset(seed=2, start=start)
    assert "\n" not in str(caught.value)
    after = env.reset(seed=1, start=3).observation  # and has left no trace
    for name, value in before.items():
        np.testing.assert_array_equal(after[name], value)


def test_an_unknown_name_is_answered_with_all_there_are(env: MotorEnvironment) -> None:
    with pytest.raises(UnknownNameError, match=r"^unknown start 'middle'; there are: start_00, "):
        env.reset(start="middle")


def test_a_start_cut_off_from_the_goal_is_refused(own_room: Callable[..., Path]) -> None:
    cell = "".join(
        f'<geom name="wall_cell_{i}" type="box" pos="{x} {y} 0.5" size="{a} {b} 0.5"/>'
        for i, (x, y, a, b) in enumerate(
            [(-1, 0, 0.1, 1.1), (1, 0, 0.1, 1.1), (0, -1, 1.1, 0.1), (0, 1, 1.1, 0.1)]
        )
    )
    scene = build_scene(own_room(cell), "nomad200")
    with pytest.raises(StartError, match=r"^start \(0, 0\) is cut off from the goal .* 0\.265 m;"):
        resolve((0.0, 0.0), scene=scene)


@pytest.mark.parametrize("robot", ["nomad200", "nomad200_wheels"])
def test_the_robot_stands_where_it_was_asked_to(robot: str) -> None:
    env = load("motor", robot=robot)
    for start in (7, "start_07", (1.5, 2.5), (1.5, 2.5, -2.0), None):
        step = env.reset(seed=3, start=start)
        pose = env.physics.pose()
        if start is not None:
            np.testing.assert_allclose(pose, resolve(start), atol=1e-12)
        np.testing.assert_allclose(step.observation["odometry"][:3], pose, atol=1e-12)
        assert step.observation["odometry"][3] == 0
    env.close()


def test_a_start_serves_one_episode_only(env: MotorEnvironment) -> None:
    env.reset(seed=0, start=(1.5, 2.5))
    free = [tuple(env.reset().observation["odometry"][:2]) for _ in range(5)]
    assert (1.5, 2.5) not in free and len(set(free)) > 1


@pytest.mark.parametrize("seed", [-1, 1.5, "one", (1, -2)])
def test_a_seed_that_is_none_is_refused(env: MotorEnvironment, seed: Any) -> None:
    with pytest.raises(NomadError, match=r"^seed .*: must be a whole number from 0 on$"):
        env.reset(seed=seed)


@pytest.mark.parametrize("start", [True, False])
def test_true_and_false_are_no_numbers_of_starts(start: bool) -> None:
    with pytest.raises(StartError, match=f"start {start}"):
        resolve(start)


def test_a_heading_of_many_turns_is_told_as_one(env: MotorEnvironment) -> None:
    step = env.reset(seed=0, start=(5.0, 3.3, 1000 * math.pi + 0.5))
    assert step.observation["odometry"][2] == pytest.approx(0.5)
    env.reset(seed=0, start=(5.0, 3.3, 1e17))
    assert abs(env.step(np.zeros(3)).observation["odometry"][2]) <= math.pi


@pytest.mark.parametrize("action", [0.3, [0.3], [0.0, np.nan, 0.0], [0.0, np.inf, -np.inf]])
def test_an_action_is_a_finite_number_for_each_motor(env: MotorEnvironment, action: Any) -> None:
    env.reset(seed=0)
    with pytest.raises(ValueError, match="must be 3 finite numbers, one for each motor"):
        env.step(action)
    assert env.step(np.zeros(3)).mid(), "nothing has happened"


@pytest.mark.parametrize("task", ["motor", "path_finding"])
def test_after_close_every_call_says_so(task: Any) -> None:
    made: Any = load(task)
    made.reset()
    made.close()
    made.close()
    with pytest.raises(RuntimeError, match="has been closed"):
        made.step(np.zeros(made.action_spec().shape))
    with pytest.raises(RuntimeError, match="has been closed"):
        made.reset()
