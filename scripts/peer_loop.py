"""One simulator, stepped with random actions as fast as it goes; run by measure_peers.py.

    python peer_loop.py NAME < REQUESTS

Runs in the simulator's own environment and needs nothing but it. First it writes a line of JSON
with the versions; then, for each line with a number of seconds, one with what it did for so long.
"""

import dataclasses
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any, TextIO

import numpy as np
import numpy.typing as npt

Step = Callable[[], float]  # one step; returns the simulated time that passed [s]
_ACTIONS = 1000  # drawn beforehand: to draw them is no part of a simulator
_ROOM = """\
world: {height: 10, width: 10}
robot:
  - kinematics: {name: diff}
    shape: {name: circle, radius: 0.2}
    state: [1, 1, 0]
    goal: [9, 9, 0]
    sensors: [{type: lidar2d}]
obstacle:
  - {shape: {name: rectangle, length: 10, width: 0.1}, state: [5, 0, 0]}
  - {shape: {name: rectangle, length: 10, width: 0.1}, state: [5, 10, 0]}
  - {shape: {name: rectangle, length: 0.1, width: 10}, state: [0, 5, 0]}
  - {shape: {name: rectangle, length: 0.1, width: 10}, state: [10, 5, 0]}
  - {shape: {name: rectangle, length: 2, width: 1.5}, state: [3, 6, 0]}
  - {shape: {name: rectangle, length: 1, width: 2}, state: [7, 3, 0]}
  - {shape: {name: rectangle, length: 1.5, width: 1}, state: [7, 7, 0]}
"""


class _Hashable(np.ndarray):  # type: ignore[type-arg]
    """An array that a dataclass of Python 3.11 and later takes for a default."""

    __hash__ = object.__hash__  # type: ignore[assignment]


def allow_array_defaults() -> None:
    """Let dataclasses have arrays for defaults, as they could when Safety-Gymnasium was written."""
    module: Any = dataclasses
    made = module._get_field

    def make(owner: type, name: str, *rest: Any) -> Any:
        default = getattr(owner, name, None)
        if isinstance(default, np.ndarray):
            setattr(owner, name, default.view(_Hashable))
        return made(owner, name, *rest)

    module._get_field = make


def drawn(low: Any, high: Any) -> Callable[[], npt.NDArray[np.float64]]:
    """Return what gives random actions between bounds, the same ones each time."""
    rng = np.random.default_rng(0)
    actions = rng.uniform(low, high, (_ACTIONS, *np.shape(low)))
    number = -1

    def draw() -> npt.NDArray[np.float64]:
        nonlocal number
        number = (number + 1) % _ACTIONS
        return actions[number]

    return draw


def gymnasium_step(env: Any, clock: Callable[[], float]) -> Step:
    """Return the step of a Gymnasium environment; an episode that is over begins anew."""
    env.reset(seed=0)
    draw = drawn(env.action_space.low, env.action_space.high)

    def step() -> float:
        before = clock()
        over = env.step(draw())[-3:-1]  # terminated, truncated
        passed = clock() - before
        if any(over):
            env.reset()
        return passed

    return step


def safety_gymnasium() -> Step:
    """Return the step of SafetyPointGoal1-v0: a point, hazards, 16-bin lidars of the truth."""
    allow_array_defaults()
    import safety_gymnasium as safety  # pyright: ignore

    env: Any = safety.make("SafetyPointGoal1-v0")
    return gymnasium_step(env, lambda: float(env.unwrapped.task.data.time))


def point_maze() -> Step:
    """Return the step of PointMaze_Large-v3: a ball among walls, without range sensors."""
    import gymnasium
    import gymnasium_robotics  # pyright: ignore

    gymnasium.register_envs(gymnasium_robotics)
    env: Any = gymnasium.make("PointMaze_Large-v3")
    return gymnasium_step(env, lambda: float(env.unwrapped.point_env.data.time))


def ir_sim() -> Step:
    """Return the step of a differential robot with IR-SIM's lidar in a room, kinematics only."""
    import irsim  # pyright: ignore

    with tempfile.TemporaryDirectory() as folder:
        room = Path(folder) / "room.yaml"
        room.write_text(_ROOM)
        env: Any = irsim.make(str(room), headless=True, log_level="ERROR")
    draw = drawn(env.robot.vel_min, env.robot.vel_max)

    def step() -> float:
        before = env.time
        env.step(draw())
        env.get_lidar_scan()
        passed = env.time - before
        if env.done():
            env.reset()
        return passed

    return step


def motor() -> Step:
    """Return the step of our motor task: physics, all sensors."""
    import nomad_mj

    env = nomad_mj.load("motor", task_kwargs={"random": 0})
    env.reset(seed=0)
    bounds = env.action_spec()
    draw = drawn(bounds.minimum, bounds.maximum)

    def step() -> float:
        before = env.physics.time()
        over = env.step(draw()).last()
        passed = env.physics.time() - before
        if over:
            env.reset()
        return passed

    return step


LOOPS: dict[str, tuple[Callable[[], Step], tuple[str, ...]]] = {
    "safety-gymnasium": (safety_gymnasium, ("safety-gymnasium", "mujoco", "numpy")),
    "ir-sim": (ir_sim, ("ir-sim", "numpy")),
    "point-maze": (point_maze, ("gymnasium-robotics", "mujoco", "numpy")),
    "nomad_mj": (motor, ("nomad-mj", "mujoco", "numpy")),
}


def block(step: Step, seconds: float) -> dict[str, float]:
    """Go on for so long; return the steps, the simulated and the real time [s]."""
    began = time.perf_counter()
    steps, simulated, passed = 0, 0.0, 0.0
    while passed < seconds:
        simulated += step()
        steps += 1
        passed = time.perf_counter() - began
    return {"steps": steps, "simulated": simulated, "seconds": passed}


def serve(name: str, requests: TextIO, answers: TextIO) -> None:
    """Answer requests until there are no more."""
    make, packages = LOOPS[name]
    step = make()
    for _ in range(20):  # what is done only once is not to count
        step()
    versions = {package: metadata.version(package) for package in packages}
    print(json.dumps({"python": sys.version.split()[0], **versions}), file=answers, flush=True)
    for request in requests:
        print(json.dumps(block(step, float(request))), file=answers, flush=True)


if __name__ == "__main__":
    # Simulators print greetings: what they print goes where errors go.
    with os.fdopen(os.dup(1), "w") as output:
        os.dup2(2, 1)
        serve(sys.argv[1], sys.stdin, output)
