"""Where everything is at every control step of an episode."""

from types import TracebackType

import numpy as np
from typing_extensions import Self

from nomad_agents.agent import Agent
from nomad_agents.episode import Episode, run_episode
from nomad_agents.experiments.pictures import Film, rounded
from nomad_mj.envs import PathFinding
from nomad_mj.scene import CONTROL_TIMESTEP
from nomad_mj.types import FloatArray

_STRIDE = 5  # control steps between the pictures of a film


class Camera:
    """Looks on from above while an episode runs.

    Parameters
    ----------
    env : PathFinding
        Its `on_control_step` is borrowed for the ``with`` block.
    """

    def __init__(self, env: PathFinding) -> None:
        self._env = env
        self._robot: list[tuple[float, float, float]] = []
        self._goal: list[FloatArray] = []
        self._obstacles: list[FloatArray] = []

    def __enter__(self) -> Self:
        self._before = self._env.on_control_step
        self._env.on_control_step = self._look
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._env.on_control_step = self._before

    def run(
        self,
        agent: Agent,
        seed: np.random.SeedSequence,
        start: FloatArray,
        explore: np.random.Generator | None,
        max_decisions: int,
    ) -> Episode:
        """Run an episode from `start` (3,) and look on; see `run_episode`."""
        return run_episode(
            self._env,
            agent,
            seed=seed,
            start=start.tolist(),
            explore=explore,
            max_decisions=max_decisions,
        )

    def _look(self) -> None:
        task = self._env.motor.task
        self._robot.append(self._env.physics.pose())
        self._goal.append(task.goal)
        self._obstacles.append(np.zeros((0, 2)) if task.movers is None else task.movers.obstacles)

    @property
    def track(self) -> FloatArray:
        """Positions (t, 2) of the robot, first its start [m]."""
        start = self._env.motor.task.start_pose[:2]
        return np.array([start, *(pose[:2] for pose in self._robot)])

    def film(self, reached: bool) -> Film:
        """Return where everything was, at every fifth control step and the last."""
        last = len(self._robot) - 1
        steps = [*range(0, last, _STRIDE), last] if last >= 0 else []
        movers = self._env.motor.task.movers
        radii = movers.radii.tolist() if movers is not None else []
        return {
            "times": [round((step + 1) * CONTROL_TIMESTEP, 3) for step in steps],
            "robot": [[round(value, 4) for value in self._robot[step]] for step in steps],
            "goal": [rounded(self._goal[step][None])[0] for step in steps],
            "obstacles": [rounded(self._obstacles[step]) for step in steps],
            "radius": max(radii, default=0.0),
            "reached": reached,
        }
