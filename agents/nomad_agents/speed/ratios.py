"""Speed, as ratios to bare MuJoCo measured in the same run: what `nomad-mj bench` prints."""

import time
from collections.abc import Callable

import mujoco
import numpy as np

import nomad_mj
from nomad_agents.reactive_planner import FAITHFUL, ReactivePlanner, ReactivePlannerConfig, plan
from nomad_agents.training import Training, TrainingConfig, train
from nomad_mj.arenas import Nearby
from nomad_mj.envs import DEFAULT_ROBOT, percept_of
from nomad_mj.scene import CONTROL_TIMESTEP, Scene
from nomad_mj.types import FloatArray

EXEMPLARS = 500
_DRIVE: FloatArray = np.array([0.25, 0.4, 0.0])  # round in a circle: touches nothing


def timed(work: Callable[[], object], repeats: int) -> float:
    """Return the seconds that `repeats` calls take."""
    began = time.perf_counter()
    for _ in range(repeats):
        work()
    return time.perf_counter() - began


class BareLoop:
    """The least that a control step can be: one call of `mj_step` on the same model.

    That of a large room is the one that is simulated, of what is near the robot.
    """

    def __init__(self, scene: Scene) -> None:
        self._model = scene.simulated()
        self._data = mujoco.MjData(self._model)
        if scene.near_model is not None:
            nearby = Nearby(scene.model, self._model, scene.robot.reach)
            nearby.update(*scene.arena.starts[0, :2].tolist())
        self._sub_steps = round(CONTROL_TIMESTEP / self._model.opt.timestep)
        joints = [scene.model.joint(f"robot/{axis}").qposadr[0] for axis in ("base_x", "base_y")]
        self._data.qpos[joints] = scene.arena.starts[0, :2]
        self._data.ctrl[:] = _DRIVE

    def step(self) -> None:
        """Advance by one control step."""
        mujoco.mj_step(self._model, self._data, self._sub_steps)


def control_step_ratio(room: str, blocks: int = 40, steps: int = 50) -> float:
    """Return the time of a control step of the motor task over that of the bare loop, median."""
    env = nomad_mj.load("motor", room=room, task_kwargs={"random": 0, "ends_at_goal": False})
    env.reset(start=0)
    bare = BareLoop(env.task.scene)
    ratios = [
        timed(lambda: env.step(_DRIVE), steps) / timed(bare.step, steps) for _ in range(blocks)
    ]
    env.close()
    return float(np.median(ratios))


def training_ratio(room: str, decisions: int = 400) -> float:
    """Return the time of a training over that of as many control steps of the bare loop."""
    with nomad_mj.load("path_finding", room=room) as env:
        agent = ReactivePlanner(env.scene.robot.layout, FAITHFUL)
        bare = BareLoop(env.scene)
        bare_s = 0.0

        def after_episode(training: Training) -> None:
            # Beside the training, not after it: both see the same load of the machine.
            nonlocal bare_s, steps
            episode = round(training.sim_s / CONTROL_TIMESTEP) - steps
            steps += episode
            bare_s += timed(bare.step, episode)

        steps = 0
        training = Training()
        train(env, agent, TrainingConfig(max_decisions=decisions), training, after_episode)
        return training.wall_s / bare_s


def _filled_agent(scene: Scene, config: ReactivePlannerConfig, exemplars: int) -> ReactivePlanner:
    """Return an agent with so many exemplars, random but plausible."""
    agent = ReactivePlanner(scene.robot.layout, config)
    rng = np.random.default_rng(0)
    categories = max(exemplars // 10, 1)
    for category in range(categories):
        agent.network.add_category(rng.uniform(-1, 1, 2), -float(category))
    for number in range(exemplars):
        situation = rng.uniform(0, 1, config.situation.size)
        agent.network.add_exemplar(situation, number % categories)
    return agent


def decision_times(
    room: str,
    robot: str = DEFAULT_ROBOT,
    config: ReactivePlannerConfig = FAITHFUL,
    repeats: int = 300,
    exemplars: int = EXEMPLARS,
) -> tuple[float, float]:
    """Return the times of a reaction (perception to action) and of a planning, medians [s]."""
    with nomad_mj.load("path_finding", room, robot, task_kwargs={"random": 0}) as env:
        agent = _filled_agent(env.scene, config, exemplars)
        observation = env.reset(start=0).observation
        layout = env.scene.robot.layout
        percept = percept_of(observation, layout, config.situation)
        agent.network.situation[0] = percept.situation  # so that something matches
        grid = config.situation.grid

        def react() -> None:
            agent.act(percept_of(observation, layout, config.situation), None)

        def think() -> None:
            plan(percept, layout.radius, grid, config.action, config.planner)

        reaction = [timed(react, 1) for _ in range(repeats)]
        planning = [timed(think, 1) for _ in range(repeats)]
    return float(np.median(reaction)), float(np.median(planning))
