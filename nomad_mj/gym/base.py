"""What both Gymnasium environments share: episodes, seeds, rewards, costs and pictures."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, SupportsFloat

import dm_env
import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from gymnasium.error import ClosedEnvironmentError, ResetNeeded

from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError
from nomad_mj.gym.camera import Camera
from nomad_mj.gym.observations import Observer
from nomad_mj.gym.reward import RewardOptions
from nomad_mj.tasks import MotorEnvironment, MotorTask, NavigationPhysics

Action = npt.NDArray[np.floating[Any]]
_RESET_OPTIONS = ("start",)
_SUMMED = ("cost", "driven", "duration")


class NavigationEnv(gymnasium.Env[Any, Action]):
    """A Gymnasium environment around one of `nomad_mj.load`.

    Parameters
    ----------
    env : PathFinding or MotorEnvironment
        The environment below; closing this one closes it.
    observer : Observer
        Makes the observations.
    reward : RewardOptions
        What the reward is made of.
    actions : int
        Length of an action, whose components lie in [-1, 1].
    render_mode : str, optional
        "rgb_array" or None.
    camera : Camera
        Draws the pictures.

    Attributes
    ----------
    environment : PathFinding or MotorEnvironment
        The environment below.
    seen : mapping or None
        Its newest observation, whatever the learner is shown of it; None before the first.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 20}  # noqa: RUF012

    def __init__(
        self,
        env: PathFinding | MotorEnvironment,
        observer: Observer,
        reward: RewardOptions,
        actions: int,
        render_mode: str | None,
        camera: Camera,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ConfigError(f"render mode {render_mode!r}: must be 'rgb_array' or None")
        self.render_mode = render_mode
        self.environment = env
        self._observer, self._reward, self._camera = observer, reward, camera
        self.observation_space = observer.space
        self.action_space = spaces.Box(-1.0, 1.0, (actions,), np.float32)
        self.seen: Mapping[str, Any] | None = None
        self._over = self._closed = False
        self._distance = 0.0
        self._steps = 0
        self._totals: dict[str, float] = dict.fromkeys(_SUMMED, 0.0)

    @property
    def task(self) -> MotorTask:
        """The motor task, which knows goal, start and readings."""
        return self._motor.task

    @property
    def physics(self) -> NavigationPhysics:
        """The simulation."""
        return self.environment.physics

    @property
    def _motor(self) -> MotorEnvironment:
        return (
            self.environment.motor
            if isinstance(self.environment, PathFinding)
            else self.environment
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start a new episode.

        Parameters
        ----------
        seed : int, optional
            Start the sequence of episodes anew from it; None goes on with the next one.
        options : dict, optional
            ``start``: name or number of a start of the room's, or x, y[, heading] in metres and
            radians; without it one of the room's at random.

        Raises
        ------
        StartError, UnknownNameError, ConfigError
            A start that there is not, another option.
        ClosedEnvironmentError
            The environment has been closed.
        """
        if self._closed:
            raise ClosedEnvironmentError("the environment has been closed: make another one")
        super().reset(seed=seed)
        options = options or {}
        for name in options:
            if name not in _RESET_OPTIONS:
                raise ConfigError(f"unknown reset option {name!r}; there is: start")
        step = self.environment.reset(seed, options.get("start"))
        self.seen, self._over, self._steps = step.observation, False, 0
        self._totals = dict.fromkeys(_SUMMED, 0.0)
        self._distance = self.task.goal_distance(self.physics)
        if self.render_mode is not None:
            self._camera.begin(self.physics)
        return self._observer(step.observation, True), self._info(step)

    def step(self, action: Action) -> tuple[Any, SupportsFloat, bool, bool, dict[str, Any]]:
        """Act; return observation, reward, terminated, truncated, info.

        Parameters
        ----------
        action : array
            In [-1, 1]; what lies outside is clipped.

        Raises
        ------
        ResetNeeded
            The episode is over, or none has begun.
        ValueError
            An action of another shape, or with numbers that are not finite.
        """
        if self.seen is None or self._over:
            raise ResetNeeded("the episode is over: call reset() before the next step()")
        action = np.asarray(action, dtype=np.float64)
        if action.shape != self.action_space.shape or not np.isfinite(action).all():
            (count,) = self.action_space.shape or (0,)
            raise ValueError(f"action {action}: must be {count} finite numbers in [-1, 1]")
        step = self.environment.step(self._command(action.clip(-1.0, 1.0)))
        self.seen, self._over = step.observation, step.last()
        self._steps += 1
        before, self._distance = self._distance, self.task.goal_distance(self.physics)
        if self.render_mode is not None:
            self._camera.follow(self.physics)
        info = self._info(step)
        terminated = step.last() and step.discount == 0.0
        reward = self._reward.total(float(step.reward), info["is_success"], before - self._distance)
        observed = self._observer(step.observation, False)
        return observed, reward, terminated, step.last() and not terminated, info

    @abstractmethod
    def _command(self, action: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return the action of the environment below."""

    @abstractmethod
    def _measures(self, step: dm_env.TimeStep) -> dict[str, Any]:
        """Return what `info` tells of this step alone; at least cost, driven and duration."""

    def _info(self, step: dm_env.TimeStep) -> dict[str, Any]:
        """Return measures, costs and the truth, the same keys in every step."""
        measures = self._measures(step)
        for name in _SUMMED:
            self._totals[name] += measures[name]
        return {
            **measures,
            "goal_distance": self._distance,
            "pose": np.array(self.physics.pose()),
            "is_success": bool(self._distance <= self.task.config.goal_radius),
            **{f"total_{name}": value for name, value in self._totals.items()},
        }

    def render(self) -> npt.NDArray[np.uint8] | None:  # type: ignore[override]
        """Return a picture of the present state, (height, width, 3); None without a render mode.

        Raises
        ------
        RenderError
            No OpenGL works here.
        """
        if self.render_mode is None:
            gymnasium.logger.warn("no render_mode was given to make(): render() draws nothing")
            return None
        if self.seen is None:
            raise ResetNeeded("there is nothing to draw before the first reset()")
        fields = (("step", str(self._steps)), ("cost", f"{self._totals['cost']:g}"))
        elapsed = 1.0 / self.metadata["render_fps"]
        return self._camera.picture(self.physics, self.seen, elapsed, fields)

    def close(self) -> None:
        """Free the simulation and its OpenGL contexts; more than once does no harm."""
        if not self._closed:
            self._closed, self.seen = True, None
            self._camera.close()
            self.environment.close()


def picture_size(width: int | None, height: int | None) -> tuple[int, int] | None:
    """Return a size of pictures [px]; ConfigError for one number without the other."""
    if width is None and height is None:
        return None
    if width is None or height is None:
        raise ConfigError(f"picture {width} x {height}: give width and height, or neither")
    return width, height


def refuse_observation(given: str, known: Sequence[str]) -> None:
    """Raise ConfigError for a kind of observation that is not known."""
    if given not in known:
        raise ConfigError(f"unknown observation {given!r}; there are: {', '.join(known)}")
