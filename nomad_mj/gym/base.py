"""What both Gymnasium environments share: episodes, seeds, rewards, costs and pictures."""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, SupportsFloat

import gymnasium
import numpy as np
import numpy.typing as npt
from dm_control.rl.control import PhysicsError
from gymnasium import spaces
from gymnasium.error import ClosedEnvironmentError, ResetNeeded

from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError
from nomad_mj.gym.account import Account, Measures
from nomad_mj.gym.camera import Camera
from nomad_mj.gym.observations import Observer
from nomad_mj.gym.reward import RewardOptions
from nomad_mj.option_types import check_types
from nomad_mj.tasks import MotorEnvironment, MotorTask, NavigationPhysics

Action = npt.NDArray[np.floating[Any]]
_RESET_OPTIONS = ("start",)


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
    measures : callable
        What `info` tells of a step.
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
        measures: Measures,
        actions: int,
        render_mode: str | None,
        camera: Camera,
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ConfigError(f"render mode {render_mode!r}: must be 'rgb_array' or None")
        self.render_mode = render_mode
        self.environment = env
        self._camera = camera
        self._account = Account(self.task, env.physics, observer, reward, measures)
        self.observation_space = observer.space
        self.action_space = spaces.Box(-1.0, 1.0, (actions,), np.float32)
        self.seen: Mapping[str, Any] | None = None
        self._over = self._closed = False
        self._steps = 0

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
        self._refuse_closed()
        super().reset(seed=seed)
        options = options or {}
        for name in options:
            if name not in _RESET_OPTIONS:
                raise ConfigError(f"unknown reset option {name!r}; there is: start")
        self._over = True  # should it be refused
        step = self.environment.reset(seed, options.get("start"))
        self.seen, self._over, self._steps = step.observation, False, 0
        if self.render_mode is not None:
            self._camera.begin(self.physics)
        return self._account.begin(step)

    def step(self, action: Action) -> tuple[Any, SupportsFloat, bool, bool, dict[str, Any]]:
        """Act; return observation, reward, terminated, truncated, info.

        Parameters
        ----------
        action : array
            In [-1, 1]; what lies outside is clipped.

        Raises
        ------
        ClosedEnvironmentError
            The environment has been closed.
        ResetNeeded
            The episode is over, or none has begun.
        ValueError
            An action of another shape, or with numbers that are not finite.
        PhysicsError
            The simulation diverged: the episode is over.
        """
        self._refuse_closed()
        if self.seen is None or self._over:
            raise ResetNeeded("the episode is over: call reset() before the next step()")
        action = np.asarray(action, dtype=np.float64)
        if action.shape != self.action_space.shape or not np.isfinite(action).all():
            (count,) = self.action_space.shape or (0,)
            raise ValueError(f"action {action}: must be {count} finite numbers in [-1, 1]")
        try:
            step = self.environment.step(self._command(action.clip(-1.0, 1.0)))
        except PhysicsError:
            self._over = True
            raise
        self.seen, self._over = step.observation, step.last()
        self._steps += 1
        if self.render_mode is not None:
            self._camera.follow(self.physics)
        return self._account.go_on(step)

    @abstractmethod
    def _command(self, action: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return the action of the environment below."""

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
        self._refuse_closed()
        if self.seen is None:
            raise ResetNeeded("there is nothing to draw before the first reset()")
        fields = (("step", str(self._steps)), ("cost", f"{self._account.totals['cost']:g}"))
        elapsed = 1.0 / self.metadata["render_fps"]
        return self._camera.picture(self.physics, self.seen, elapsed, fields)

    def _refuse_closed(self) -> None:
        if self._closed:
            raise ClosedEnvironmentError("the environment has been closed: make another one")

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
    check_types("picture", {"width": width, "height": height}, {"width": int, "height": int})
    return width, height


def refuse_observation(given: str, known: Sequence[str]) -> None:
    """Raise ConfigError for a kind of observation that is not known."""
    if given not in known:
        raise ConfigError(f"unknown observation {given!r}; there are: {', '.join(known)}")
