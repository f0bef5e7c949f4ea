"""What a learner is paid."""

import math
from dataclasses import dataclass
from typing import Literal

from nomad_mj.errors import ConfigError
from nomad_mj.option_types import check_fields


@dataclass(frozen=True)
class RewardOptions:
    """What the reward is made of; their sum is paid.

    Attributes
    ----------
    reward : "task" or "sparse"
        That of the task below, or 1 at the goal and 0 elsewhere.
    goal_bonus : float
        Paid beside it in a step that ends at the goal, which is the last one unless the episode
        goes on there.
    progress : float
        Paid for each metre that the robot's true distance to the goal has become shorter.
    """

    reward: Literal["task", "sparse"] = "task"
    goal_bonus: float = 0.0
    progress: float = 0.0

    def __post_init__(self) -> None:
        check_fields(self)
        if self.reward not in ("task", "sparse"):
            raise ConfigError(f"reward {self.reward!r}: must be 'task' or 'sparse'")
        for name in ("goal_bonus", "progress"):
            if not math.isfinite(getattr(self, name)):
                raise ConfigError(f"{name} {getattr(self, name)}: must be a finite number")

    def total(self, task: float, reached: bool, nearer: float) -> float:
        """Return the reward of a step that brought the robot `nearer` [m] to the goal."""
        own = task if self.reward == "task" else float(reached)
        return own + self.goal_bonus * reached + self.progress * nearer
