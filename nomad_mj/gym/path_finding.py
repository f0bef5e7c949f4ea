"""``nomad_mj/PathFinding-v0``: one step is one move of the robot's."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Literal

from nomad_mj.envs import DEFAULT_ROBOT, DEFAULT_ROOM, load
from nomad_mj.gym.account import MoveMeasures
from nomad_mj.gym.base import NavigationEnv, picture_size, refuse_observation
from nomad_mj.gym.camera import Camera
from nomad_mj.gym.everything import EverythingObserver
from nomad_mj.gym.observations import Observer, RangesObserver, SituationObserver
from nomad_mj.gym.options import structure, task_options
from nomad_mj.gym.reward import RewardOptions
from nomad_mj.perception import SituationSpec
from nomad_mj.types import FloatArray


class PathFindingEnv(NavigationEnv):
    """Find the way to the goal, one move at a time; see `nomad_mj.PathFinding`.

    Actions are (dx, dy) in [-1, 1], relative to the shortest path vector. The episode terminates
    at the goal and is truncated at the time limit.

    Parameters
    ----------
    room, robot : str or Path
        The name of one that comes with the package, or an MJCF file.
    observation : "situation", "ranges" or "dict"
        What is observed; see `observations` and `everything`.
    task_kwargs : mapping, optional
        As of `nomad_mj.load`; values that are dataclasses may be given as mappings.
    goal : (float, float), optional
        Where the goal is [m], in place of the room's own.
    time_limit : float
        Length of an episode [s of simulated time].
    situation : SituationSpec or mapping, optional
        How the situation is coded.
    reward, goal_bonus, progress
        What the reward is made of, see `RewardOptions`.
    render_mode : "rgb_array", optional
        What `render` returns; None for nothing.
    view : str
        Of the pictures: "overview", "top", "chase" or "side".
    width, height : int, optional
        Of the pictures [px], even; what suits the view if None.

    Attributes
    ----------
    observation, situation
        As given.

    Raises
    ------
    NomadError
        Anything wrong with these, in one line.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 2}  # noqa: RUF012

    def __init__(
        self,
        room: str | Path = DEFAULT_ROOM,
        robot: str | Path = DEFAULT_ROBOT,
        observation: Literal["situation", "ranges", "dict"] = "situation",
        *,
        task_kwargs: Mapping[str, Any] | None = None,
        goal: Sequence[float] | None = None,
        time_limit: float = 300.0,
        situation: SituationSpec | Mapping[str, Any] | None = None,
        reward: Literal["task", "sparse"] = "task",
        goal_bonus: float = 0.0,
        progress: float = 0.0,
        render_mode: str | None = None,
        view: str = "overview",
        width: int | None = None,
        height: int | None = None,
    ) -> None:
        options = RewardOptions(reward, goal_bonus, progress)
        spec = structure("situation", situation or SituationSpec(), SituationSpec)
        refuse_observation(observation, ("situation", "ranges", "dict"))
        env = load(
            "path_finding",
            room,
            robot,
            task_options(task_kwargs),
            {"time_limit": time_limit},
            goal=goal,
        )
        try:
            camera = Camera(env.scene, view, picture_size(width, height), spec)
            observers: dict[str, Observer] = {
                "situation": SituationObserver(env.scene, spec),
                "ranges": RangesObserver(env.scene),
                "dict": EverythingObserver(env.scene, env.observation_spec()),
            }
            measures = MoveMeasures(env.motor.task)
            super().__init__(env, observers[observation], options, measures, 2, render_mode, camera)
        except BaseException:
            env.close()
            raise
        self.observation, self.situation = observation, spec
        if render_mode is not None:
            # No lambda: a copy of the environment must follow its own robot.
            env.on_control_step = partial(camera.follow, env.physics)

    def _command(self, action: FloatArray) -> FloatArray:
        return action
