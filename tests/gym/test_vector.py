"""The vector environments are the single ones side by side, to the bit, in every mode."""

import math
from typing import Any

import gymnasium
import numpy as np
import pytest
from dm_control.rl.control import PhysicsError
from gymnasium.vector import AutoresetMode, SyncVectorEnv, VectorEnv

from nomad_mj.errors import NomadError
from nomad_mj.gym.base import NavigationEnv
from nomad_mj.gym.registration import MOTOR, PATH_FINDING
from nomad_mj.gym.vector import NavigationVectorEnv

ROOMS = ["paper_room", "hall", "paper_room"]
Vector = VectorEnv[Any, Any, Any]
NOISY = {"range_noise": {"kind": "gaussian", "level": 0.2}, "bumper_noise": {"hold": 0.2}}


def same(one: Any, other: Any, where: str) -> None:
    """Fail unless two results are the same, to the bit and to the key."""
    if isinstance(one, dict):
        assert isinstance(other, dict) and sorted(one) == sorted(other), where
        for key, value in one.items():
            same(value, other[key], f"{where}.{key}")
    elif isinstance(one, tuple) or (isinstance(one, np.ndarray) and one.dtype == object):
        for number, (a, b) in enumerate(zip(one, other, strict=True)):
            same(a, b, f"{where}[{number}]")
    elif isinstance(one, np.ndarray):
        assert one.dtype == other.dtype and one.tobytes() == other.tobytes(), (where, one, other)
    else:
        assert one == other, (where, one, other)


def pair(name: str, mode: AutoresetMode, observation: str, limit: int) -> tuple[Vector, Vector]:
    pay = {"goal_bonus": 2.0, "progress": 0.5}
    options: dict[str, Any] = {"observation": observation, "task_kwargs": NOISY, **pay}
    many = gymnasium.make_vec(
        name,
        num_envs=len(ROOMS),
        vectorization_mode="vector_entry_point",
        room=ROOMS,
        threads=2,
        autoreset_mode=mode,
        max_episode_steps=limit,
        **options,
    )
    ones = SyncVectorEnv(
        [
            lambda room=room: gymnasium.make(name, max_episode_steps=limit, room=room, **options)
            for room in ROOMS
        ],
        observation_mode="different" if observation == "dict" else "same",
        autoreset_mode=mode,
    )
    return many, ones


def test_a_sparse_reward_pays_progress_and_the_goal_alone_to_one_and_to_many() -> None:
    pay: dict[str, Any] = {"reward": "sparse", "goal_bonus": 2.0, "progress": 3.0}
    one = gymnasium.make(MOTOR, room="empty_room", **pay)
    many = gymnasium.make_vec(MOTOR, 1, "vector_entry_point", room="empty_room", threads=1, **pay)
    goal = one.get_wrapper_attr("task").goal
    options, over = {"start": (goal[0] - 0.6, goal[1], 0.0)}, False
    before = one.reset(seed=0, options=options)[1]["goal_distance"]
    many.reset(seed=0, options=options)
    while not over:
        _, reward, over, _, info = one.step(np.array([1, 0, 0], dtype=np.float32))
        nearer, before = before - info["goal_distance"], info["goal_distance"]
        assert reward == pytest.approx(3.0 * nearer + 3.0 * info["is_success"], abs=1e-12)
        assert many.step(np.array([[1.0, 0, 0]]))[1][0] == reward
    one.close()
    many.close()


@pytest.mark.parametrize(
    ("name", "mode", "observation"),
    [
        (PATH_FINDING, AutoresetMode.NEXT_STEP, "situation"),
        (PATH_FINDING, AutoresetMode.SAME_STEP, "dict"),
        (MOTOR, AutoresetMode.NEXT_STEP, "dict"),
        (MOTOR, AutoresetMode.SAME_STEP, "ranges"),
        (MOTOR, AutoresetMode.DISABLED, "ranges"),
    ],
)
def test_every_step_is_that_of_single_environments(
    name: str, mode: AutoresetMode, observation: str
) -> None:
    many, ones = pair(name, mode, observation, 3 if name == PATH_FINDING else 7)
    assert many.metadata["autoreset_mode"] is mode
    same(many.reset(seed=11), ones.reset(seed=11), "reset")
    many.action_space.seed(0)
    assert many.single_observation_space.shape == ones.single_observation_space.shape
    ended = 0
    for number in range(6 if name == PATH_FINDING else 18):
        actions = many.action_space.sample()
        told, wanted = many.step(actions), ones.step(actions)
        same(told, wanted, str(number))
        if observation != "dict":
            assert many.observation_space.contains(told[0])
        over = told[2] | told[3]
        ended += int(over.sum())
        if mode is AutoresetMode.DISABLED and over.any():
            same(
                many.reset(options={"reset_mask": over}),
                ones.reset(options={"reset_mask": over}),
                "masked",
            )
    assert ended
    many.close()
    ones.close()


def test_a_reset_can_be_of_some_with_starts() -> None:
    many = gymnasium.make_vec(PATH_FINDING, num_envs=2, room="paper_room", threads=1)
    assert many.spec is not None  # without a mode it is the entry point
    first, _ = many.reset(seed=3, options={"starts": [0, 1]})
    mask = np.array([False, True])
    second, infos = many.reset(options={"reset_mask": mask, "start": 2})
    assert np.array_equal(first[0], second[0]) and not np.array_equal(first[1], second[1])
    assert infos["_pose"].tolist() == mask.tolist()
    many.close()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"render_mode": "rgb_array"}, "many at once are not drawn"),
        ({"autoreset_mode": "never"}, "autoreset mode 'never': must be one of NEXT_STEP"),
        ({"observation": "smell"}, "unknown observation 'smell'"),
    ],
)
def test_what_cannot_be_made_is_told_in_a_line(options: dict[str, Any], says: str) -> None:
    with pytest.raises(NomadError, match=says) as caught:
        gymnasium.make_vec(PATH_FINDING, 2, "vector_entry_point", **options)
    assert "\n" not in str(caught.value)


def test_what_cannot_be_asked_of_it() -> None:
    many = gymnasium.make_vec(MOTOR, 2, "vector_entry_point", threads=1, autoreset_mode="Disabled")
    with pytest.raises(gymnasium.error.ResetNeeded):
        many.step(np.zeros((2, 3)))
    with pytest.raises(NomadError, match="unknown reset option 'where'; there are: reset_mask"):
        many.reset(options={"where": 1})
    many.reset(seed=0)
    with pytest.raises(ValueError, match="environment 1: action"):
        many.step(np.array([[0, 0, 0], [0, np.nan, 0]]))
    with pytest.raises(ValueError, match=r"actions of shape \(3,\)"):
        many.step(np.zeros(3))
    many.close()


@pytest.mark.parametrize("name", [MOTOR, PATH_FINDING])
def test_after_a_simulation_has_failed_a_reset_is_asked_for(name: str) -> None:
    many = gymnasium.make_vec(name, 2, "vector_entry_point", room="empty_room", threads=1)
    one = gymnasium.make(name, room="empty_room")
    size = many.single_action_space.shape or ()
    base, single = many.unwrapped, one.unwrapped
    assert isinstance(base, NavigationVectorEnv) and isinstance(single, NavigationEnv)
    for env, break_it in (
        (many, lambda: spoil(base)),
        (one, lambda: single.physics.data.qpos.__setitem__(0, np.nan)),
    ):
        env.reset(seed=0)
        action = np.full((2, *size) if env is many else size, 0.1, dtype=np.float32)
        env.step(action)
        break_it()
        with pytest.raises(PhysicsError):
            env.step(action)
        with pytest.raises(gymnasium.error.ResetNeeded):
            env.step(action)
        env.reset()
        env.step(action)
        env.close()


def spoil(env: NavigationVectorEnv) -> None:
    """Let the simulation of world 1 diverge."""
    lot, row = env.batch.worlds._simulations._where[1]  # pyright: ignore[reportPrivateUsage]
    lot._qpos[row, 0] = np.nan  # pyright: ignore[reportPrivateUsage]


def test_when_closed_it_says_so() -> None:
    many = gymnasium.make_vec(MOTOR, 2, "vector_entry_point", threads=1)
    many.reset(seed=7)
    assert many.np_random_seed == 7
    many.close()
    with pytest.raises(gymnasium.error.ClosedEnvironmentError):
        many.reset()
    with pytest.raises(gymnasium.error.ClosedEnvironmentError):
        many.step(np.zeros((2, 3)))


@pytest.mark.parametrize("limit", [math.inf, 1.0])
def test_the_goal_in_the_last_step_is_a_termination(limit: float) -> None:
    one = gymnasium.make(MOTOR, room="empty_room", time_limit=limit)
    many = gymnasium.make_vec(
        MOTOR, 1, "vector_entry_point", room="empty_room", time_limit=limit, threads=1
    )
    base = one.unwrapped
    assert isinstance(base, NavigationEnv)
    goal = base.task.goal
    options = {"start": (goal[0] - 0.6, goal[1], 0.0)}
    one.reset(seed=0, options=options)
    many.reset(seed=0, options=options)
    ended: list[Any] = []
    for step in range(1, 41):
        told = one.step(np.array([1.0, 0.0, 0.0], dtype=np.float32))
        others = many.step(np.array([[1.0, 0.0, 0.0]]))
        assert told[2:4] == (others[2][0], others[3][0])
        if told[2] or told[3]:
            ended = [step, *told[2:4]]
            break
    assert ended == [20, True, False]
    one.close()
    many.close()
