"""dm_control's wrappers and its viewer work on the motor task."""

import subprocess
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import dm_env
import mujoco
import numpy as np
import pytest
from dm_control.rl.control import Environment
from dm_control.suite.wrappers import action_noise, action_scale, pixels

from nomad_mj import MotorEnvironment, load

ROOT = Path(__file__).resolve().parents[2]
ACTION = (0.3, 0.4, -0.2)


@pytest.fixture
def env() -> Iterator[MotorEnvironment]:
    made = load("motor", task_kwargs={"random": 0}, environment_kwargs={"time_limit": 2.0})
    yield made
    made.close()


def told(step: dm_env.TimeStep) -> list[float]:
    return np.concatenate([np.ravel(value) for value in step.observation.values()]).tolist()


def test_the_motor_task_is_a_dm_control_environment(env: MotorEnvironment) -> None:
    assert isinstance(env, Environment)
    assert env.physics.model.nu >= 3 and env.physics.named.model.numeric_data is not None
    assert env.physics.control().shape == (env.physics.model.nu,)


def test_scaled_actions_mean_the_motors_limits(env: MotorEnvironment) -> None:
    scaled = action_scale.Wrapper(env, minimum=-1.0, maximum=1.0)
    limit = env.action_spec().maximum
    first = told(scaled.reset())
    after = [told(scaled.step(np.array([0.5, -1, 1]))) for _ in range(5)]
    env.task.seed(0)
    assert told(env.reset()) == first
    assert [told(env.step(limit * [0.5, -1, 1])) for _ in range(5)] == after


def test_noisy_actions_are_drawn_from_the_tasks_seed(env: MotorEnvironment) -> None:
    noisy = action_noise.Wrapper(env, scale=0.1)
    runs: list[list[list[float]]] = []
    for _ in range(2):
        env.task.seed(0)
        noisy.reset()
        runs.append([told(noisy.step(np.array(ACTION))) for _ in range(5)])
    assert runs[0] == runs[1]
    env.task.seed(0)
    env.reset()
    assert [told(env.step(ACTION)) for _ in range(5)] != runs[0]


@pytest.mark.gl
def test_pixels_are_added_to_the_observations_or_take_their_place(env: MotorEnvironment) -> None:
    camera = {"height": 48, "width": 64, "camera_id": "room/top"}
    both = pixels.Wrapper(env, pixels_only=False, render_kwargs=camera)
    only = pixels.Wrapper(env, render_kwargs=camera)
    assert set(both.observation_spec()) == {*env.observation_spec(), "pixels"}
    assert set(only.observation_spec()) == {"pixels"}
    for step in (both.reset(), both.step(ACTION)):
        image = step.observation["pixels"]
        both.observation_spec()["pixels"].validate(image)
        assert image.shape == (48, 64, 3) and np.ptp(image) > 50
    for step in (only.reset(), only.step(ACTION)):
        assert set(step.observation) == {"pixels"}


@pytest.mark.gl
def test_drawing_does_not_change_what_happens(env: MotorEnvironment) -> None:
    env.reset(seed=1)
    plain = [told(env.step(ACTION)) for _ in range(5)]
    env.reset(seed=1)
    drawn: list[list[float]] = []
    for _ in range(5):
        drawn.append(told(env.step(ACTION)))
        env.physics.render(48, 64, camera_id="robot/chase")
    assert drawn == plain


@pytest.mark.gl
def test_a_closed_environment_leaves_no_word_at_exit(tmp_path: Path) -> None:
    code = (
        f"import sys; sys.path.insert(0, {str(ROOT)!r})\n"
        "import nomad_mj\n"
        "for task in ('motor', 'path_finding'):\n"
        "    env = nomad_mj.load(task); env.reset(); env.physics.render(48, 64); env.close()\n"
    )
    ran = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=False,
    )
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, "", "")
    assert not list(tmp_path.iterdir())


def viewer_runtime() -> Any:
    """Return the module of the viewer that needs no window."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # glfw warns of a missing display
        try:
            from dm_control.viewer import runtime
        except (ImportError, AttributeError) as error:
            pytest.skip(f"the viewer cannot be imported here: {error}")
    return runtime


def test_the_viewer_runs_pauses_and_restarts_it(env: MotorEnvironment) -> None:
    runtime = viewer_runtime()
    errors: list[Any] = []

    def policy(step: dm_env.TimeStep) -> tuple[float, ...]:
        assert env.task.get_observation(env.physics).keys() == step.observation.keys()
        return ACTION

    viewer = runtime.Runtime(env, policy)
    viewer.on_error += errors.append
    for _ in range(10):
        viewer.tick(0.05, paused=False)
    state, moved = viewer.state, env.physics.pose()
    assert state == runtime.State.RUNNING and viewer.get_time() > 0.3 and not errors
    viewer.tick(0.05, paused=True)
    assert env.physics.pose() == moved
    viewer.restart()
    viewer.tick(0.01, paused=False)
    assert viewer.get_time() <= 0.06
    for _ in range(60):
        viewer.tick(0.05, paused=False)
    assert viewer.state == runtime.State.STOPPED and not errors  # the time limit


def test_the_viewers_own_action_stands_still(env: MotorEnvironment) -> None:
    viewer = viewer_runtime().Runtime(env)
    for _ in range(5):
        viewer.tick(0.05, paused=False)
    assert np.abs(env.physics.data.qvel).max() < 1e-6


def test_a_pause_of_the_viewer_changes_nothing(env: MotorEnvironment) -> None:
    env.reset(seed=1)
    plain = [told(env.step(ACTION)) for _ in range(8)]
    env.reset(seed=1)
    paused: list[list[float]] = []
    for _ in range(8):
        paused.append(told(env.step(ACTION)))
        mujoco.mj_forward(env.physics.model.ptr, env.physics.data.ptr)  # as the viewer does
    assert paused == plain
