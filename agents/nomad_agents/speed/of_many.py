"""Speed of many robots in one process, as ratios to what else one would do, in the same run."""

import warnings
from functools import partial

import gymnasium
import numpy as np

import nomad_mj
from nomad_agents.speed.ratios import BareLoop, timed
from nomad_mj.gym import registration
from nomad_mj.perception import SituationSpec, perceive
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.types import FloatArray

ROBOTS = 64
THREADS = 2
PERCEPTS = 4096
_ROUND: FloatArray = np.array([0.25, 0.4, 0.0])  # m/s, rad/s: in a circle, touching nothing


def batch_ratio(room: str, blocks: int = 30, steps: int = 4) -> float:
    """Return the control steps a second of a batch over those of the bare loop, median.

    The batch has 64 robots on 2 threads; the bare loop is one `mj_step` of one model on one.
    """
    kwargs = {"random": 0, "ends_at_goal": False}
    with nomad_mj.load_batch("motor", ROBOTS, room, task_kwargs=kwargs, threads=THREADS) as many:
        many.reset(starts=[0] * ROBOTS)
        commands = np.tile(_ROUND, (ROBOTS, 1))
        bare = BareLoop(many.scenes[0])
        step = partial(many.step, commands)
        timed(step, 2)
        ratios = [
            timed(bare.step, steps * ROBOTS // 2) * 2 / timed(step, steps) for _ in range(blocks)
        ]
    return float(np.median(ratios))


def async_ratio(room: str, blocks: int = 20, steps: int = 40) -> float:
    """Return the control steps a second of a batch over those of Gymnasium's processes, median.

    `AsyncVectorEnv` has two processes with the single environment in each; the batch as many
    threads, and 64 robots.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # forking where there are threads: these stand still
        processes = gymnasium.make_vec(
            registration.MOTOR, THREADS, "async", room=room, task_kwargs={"ends_at_goal": False}
        )
    kwargs = {"random": 0, "ends_at_goal": False}
    try:
        processes.reset(seed=0)
        actions = np.full((THREADS, 3), 0.1, dtype=np.float32)
        with nomad_mj.load_batch(
            "motor", ROBOTS, room, task_kwargs=kwargs, threads=THREADS
        ) as many:
            many.reset(starts=[0] * ROBOTS)
            step = partial(many.step, np.tile(_ROUND, (ROBOTS, 1)))
            other = partial(processes.step, actions)
            timed(step, 2)
            timed(other, 2)
            rounds = max(steps * THREADS // ROBOTS, 1)
            ratios = [
                timed(other, steps) / (steps * THREADS) / (timed(step, rounds) / (rounds * ROBOTS))
                for _ in range(blocks)
            ]
    finally:
        processes.close()
    return float(np.median(ratios))


def perception_ratio(room: str, blocks: int = 11, singles: int = 256) -> float:
    """Return the time of single perceptions over that of as many at once, 4096, median.

    Those at once are on 2 threads.
    """
    with nomad_mj.load("motor", room=room) as env:
        layout = env.task.scene.robot.layout
    rng, spec = np.random.default_rng(0), SituationSpec()
    ranges = rng.uniform(0.1, 4.0, (PERCEPTS, layout.count))
    headings = rng.uniform(-np.pi, np.pi, PERCEPTS)
    goals = rng.uniform(-5.0, 5.0, (PERCEPTS, 2))

    def one_by_one() -> None:
        for number in range(singles):
            perceive(ranges[number], headings[number], goals[number], layout, spec)

    at_once = partial(perceive, ranges, headings, goals, layout, spec, THREADS)
    timed(at_once, 1)
    ratios = [
        timed(one_by_one, 1) / singles / (timed(at_once, 1) / PERCEPTS) for _ in range(blocks)
    ]
    return float(np.median(ratios))


def simulated_rate(room: str, blocks: int = 20, steps: int = 40) -> float:
    """Return the simulated seconds a second of one environment with all sensors, median."""
    env = nomad_mj.load("motor", room=room, task_kwargs={"random": 0, "ends_at_goal": False})
    env.reset(start=0)
    step = partial(env.step, _ROUND)
    rates = [steps * CONTROL_TIMESTEP / timed(step, steps) for _ in range(blocks)]
    env.close()
    return float(np.median(rates))
