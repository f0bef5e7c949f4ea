"""What is below is what is seen: to the bit, in any process, again and again."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from hypothesis import given, settings
from hypothesis import strategies as st

import nomad_mj
from nomad_mj.envs import percept_of
from nomad_mj.gym.registration import MOTOR, PATH_FINDING
from nomad_mj.perception import SituationSpec

NOISY = {
    "range_noise": {"kind": "gaussian", "level": 0.3, "grazing": 0.5},
    "odometry_noise": {"position": 0.2},
    "moving_goal": {"speed": 0.1},
    "moving_obstacles": {"count": 2},
}
MADE = {
    "range_noise": nomad_mj.RangeNoise("gaussian", 0.3, grazing=0.5),
    "odometry_noise": nomad_mj.OdometryNoise(position=0.2),
    "moving_goal": nomad_mj.MovingGoal(speed=0.1),
    "moving_obstacles": nomad_mj.MovingObstacles(count=2),
}


def episode(env: "gymnasium.Env[Any, Any]", seed: int | None, steps: int) -> list[Any]:
    """Return all that random actions bring."""
    env.action_space.seed(7)
    rows: list[Any] = [env.reset(seed=seed)]
    for _ in range(steps):
        rows.append(env.step(env.action_space.sample()))
        if rows[-1][2] or rows[-1][3]:
            break
    return rows


def flat(value: Any) -> list[Any]:
    if isinstance(value, dict):
        return [flat(part) for _, part in sorted(value.items())]
    if isinstance(value, list | tuple):
        return [flat(part) for part in value]
    return [np.asarray(value).tolist()]


@pytest.mark.parametrize(("name", "task"), [(PATH_FINDING, "path_finding"), (MOTOR, "motor")])
def test_an_episode_is_that_of_load(name: str, task: Any) -> None:
    env = gymnasium.make(
        name,
        room="paper_room",
        robot="pioneer",
        observation="dict",
        goal=(8.0, 6.0),
        task_kwargs=NOISY,
    )
    below = nomad_mj.load(task, "paper_room", "pioneer", MADE, goal=(8.0, 6.0))
    rows = episode(env, 5, 8)
    env.action_space.seed(7)
    step = below.reset(seed=5)
    spec = below.action_spec()
    for row in rows:
        observed = row[0]
        assert observed["goal"].dtype == np.float64
        for key, value in observed.items():
            if key != "odometry":
                assert np.array_equal(np.ravel(value), np.ravel(step.observation[key])), key
        assert np.array_equal(observed["odometry"][:2], step.observation["odometry"][:2])
        if len(row) == 5:
            assert row[1] == step.reward
        action = env.action_space.sample().astype(np.float64)
        step = below.step(action if task == "path_finding" else action * spec.maximum)
    env.close()
    below.close()


def test_seeds_begin_a_sequence_that_goes_on_without_them() -> None:
    env = gymnasium.make(PATH_FINDING, room="paper_room", robot="khepera")
    first, second = episode(env, 3, 2), episode(env, None, 2)
    again, on = episode(env, 3, 2), episode(env, None, 2)
    assert flat(first) == flat(again) and flat(second) == flat(on)
    assert flat(first) != flat(second)
    env.close()


def test_options_survive_a_specification_written_as_json() -> None:
    env = gymnasium.make(
        PATH_FINDING,
        room="paper_room",
        robot="pioneer",
        task_kwargs=MADE,
        goal=(8.0, 6.0),
        situation=SituationSpec(circular=True),
        max_episode_steps=7,
    )
    assert env.spec is not None
    again = gymnasium.make(EnvSpec.from_json(env.spec.to_json()))
    assert flat(episode(env, 1, 3)) == flat(episode(again, 1, 3))
    env.close()
    again.close()


@pytest.mark.parametrize("context", ["fork", "spawn"])
def test_other_processes_come_to_the_same(context: str) -> None:
    options: dict[str, Any] = {"room": "paper_room", "robot": "pioneer"}
    envs: Any = gymnasium.make_vec(
        PATH_FINDING, 2, "async", vector_kwargs={"context": context}, task_kwargs=NOISY, **options
    )
    alone = [gymnasium.make(PATH_FINDING, task_kwargs=NOISY, **options) for _ in range(2)]
    observed, _ = envs.reset(seed=[3, 4])
    action = np.array([[0.5, 0.5], [1.0, -0.2]], dtype=np.float32)
    after, rewards, *_ = envs.step(action)
    for i, env in enumerate(alone):
        assert np.array_equal(env.reset(seed=3 + i)[0], observed[i])
        row = env.step(action[i])
        assert np.array_equal(row[0], after[i]) and row[1] == rewards[i]
        env.close()
    envs.close()


@settings(max_examples=15)
@given(seed=st.integers(0, 2**32), data=st.data())
def test_situation_and_ranges_tell_what_everything_tells(seed: int, data: st.DataObject) -> None:
    action = np.array(data.draw(st.tuples(*[st.floats(-1, 1, width=32)] * 2)), dtype=np.float32)
    seen = [step_of(kind, seed, action) for kind in ("situation", "ranges", "dict")]
    everything: dict[str, Any] = seen[2]
    env = ENVS["dict"].unwrapped
    layout = env.get_wrapper_attr("environment").scene.robot.layout
    situation = percept_of(everything, layout, SituationSpec()).situation
    assert np.array_equal(seen[0], situation.astype(np.float32))
    x, y = everything["goal"]
    cosine, sine, near = seen[1][layout.count :].astype(float)
    turn = np.arctan2(y, x) - everything["odometry"][3]
    assert np.allclose(
        [cosine, sine, near], [np.cos(turn), np.sin(turn), np.exp(-np.hypot(x, y) / 5)]
    )
    sonar = everything["infrared"] / layout.rings[0].max_range
    assert np.array_equal(seen[1][: layout.count], sonar.astype(np.float32))


ENVS: dict[str, "gymnasium.Env[Any, Any]"] = {}


def step_of(kind: str, seed: int, action: Any) -> Any:
    """Return what is observed after one move."""
    if kind not in ENVS:
        ENVS[kind] = gymnasium.make(PATH_FINDING, robot="khepera", observation=kind)
    ENVS[kind].reset(seed=seed)
    return ENVS[kind].step(action)[0]
