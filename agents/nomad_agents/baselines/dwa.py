"""The dynamic window approach, for moves that end at rest.

Source: D. Fox, W. Burgard, S. Thrun, "The dynamic window approach to collision avoidance", IEEE
Robotics & Automation Magazine 4 (1997).

What is adapted, and why:

- The authors choose a pair of speeds every quarter of a second, of those that the motors can reach
  by then. Our robot stands when it decides, and what it decides on is a whole move, so the window
  is what a move can reach: all directions, since it turns on the spot, and all lengths up to the
  longest move. Curves are not among them: a move is straight.
- A pair of speeds is admissible if the robot can stop before the nearest obstacle. A move ends at
  rest, so it is admissible if it ends before what the map shows, with a safety distance.
- Speeds within reach of the present ones also keep a robot from turning round at once. Here the
  window leaves out what lies farther than some angle from the direction of the last move, unless
  nothing else is left; and the objective's speed is that of the whole move, its turn included.
- Distances are read off the certainty grid, where the authors use a line for each sonar echo.

- A goal that a move reaches is taken. Past a point so near the heading says nothing.

The objective is theirs: heading, clearance and speed, each in [0, 1], weighted, summed, smoothed.
"""

from dataclasses import dataclass

import numpy as np

from nomad_agents.baselines.classical import BLOCKED, NEAR, ClassicalAgent
from nomad_agents.baselines.way import free_way
from nomad_agents.reactive_planner.config import ReactivePlannerConfig
from nomad_mj.geometry import direction, wrap_angle
from nomad_mj.limits import require
from nomad_mj.perception import Percept
from nomad_mj.types import FloatArray, SensorLayout


@dataclass(frozen=True)
class DwaConfig:
    """Settings of the dynamic window approach.

    Attributes
    ----------
    heading, clearance, speed : float
        Weights of the objective: alpha, beta and gamma of the paper.
    smoothing : float
        Standard deviation of the smoothing over directions [rad].
    directions, lengths : int
        How many of each make up the window.
    turn : float
        Directions farther than this from the last move's are not in the window [rad].
    turn_way : float
        Turning by a radian takes as long as driving so far [m].
    sight : float
        Free ways count as no longer than this [m].
    safety : float
        Distance to keep from the centres of occupied cells, beside the robot's radius [m].
    occupied : float
        Above this probability a cell is in the way.
    """

    heading: float = 2.0
    clearance: float = 0.6
    speed: float = 0.4
    smoothing: float = 0.1
    directions: int = 72
    lengths: int = 5
    turn: float = np.deg2rad(100)
    turn_way: float = 0.58
    sight: float = 2.0
    safety: float = 0.2
    occupied: float = 0.5

    def __post_init__(self) -> None:
        require(
            self,
            heading=(0, np.inf),
            clearance=(0, np.inf),
            speed=(0, np.inf),
            smoothing=(0, np.pi),
            directions=(4, 3600),
            lengths=(1, 100),
            turn=(0, np.pi),
            turn_way=(0, np.inf),
            sight=(0.01, np.inf),
            safety=(0, np.inf),
            occupied=(0, 1),
        )


class DynamicWindow(ClassicalAgent[DwaConfig]):
    """Takes the admissible move of the highest objective; remembers its last direction."""

    name = "dwa"
    kind = "planned"

    def __init__(
        self,
        layout: SensorLayout,
        config: ReactivePlannerConfig,
        window: DwaConfig | None = None,
    ) -> None:
        super().__init__(layout, config, window or DwaConfig())
        step = 2 * np.pi / self.config.directions
        self._offsets = wrap_angle(np.arange(self.config.directions) * step)
        self._kernel = self._smoothing_kernel()

    def _choose(self, percept: Percept, longest: float) -> tuple[float, float]:
        """Return the best move of the window."""
        config, goal = self.config, percept.goal
        # From the goal's direction on, so that the straight way is one of them.
        headings = direction(goal) + self._offsets
        free = free_way(headings, self._occupied(percept), self._reach)
        if np.hypot(goal[0], goal[1]) <= min(longest, free[0]):
            return float(headings[0]), longest
        lengths = longest * np.arange(1, config.lengths + 1) / config.lengths
        turn = np.zeros_like(headings)
        if self._last is not None:
            turn = np.abs(wrap_angle(headings - self._last))
        admissible = lengths <= free[:, None]
        if not admissible.any():  # as far as it goes, where it goes farthest
            # Of ways equally free but for rounding, the one nearest to the goal's: the same on
            # either hand.
            freest = free >= free.max() - 1e-9
            best = int(np.argmin(np.where(freest, np.abs(self._offsets), np.inf)))
            return float(headings[best]), max(float(free[best]), BLOCKED)
        within = admissible & (turn <= config.turn)[:, None]
        admissible = within if within.any() else admissible
        value = self._objective(headings, lengths, free, turn, goal)
        value = np.where(admissible, value, -np.inf)
        best, length = np.unravel_index(int(np.argmax(value)), value.shape)
        return float(headings[best]), float(lengths[length])

    def _objective(
        self,
        headings: FloatArray,
        lengths: FloatArray,
        free: FloatArray,
        turn: FloatArray,
        goal: FloatArray,
    ) -> FloatArray:
        """Return the smoothed objective of all moves (directions, lengths)."""
        config = self.config
        ends = np.stack([np.cos(headings), np.sin(headings)], axis=-1)[:, None] * lengths[:, None]
        left = goal - ends  # (directions, lengths, 2)
        off = np.abs(wrap_angle(direction(left) - headings[:, None]))
        off = np.where(np.hypot(left[..., 0], left[..., 1]) < NEAR, 0.0, off)
        speed = lengths / (lengths[-1] + config.turn_way * turn[:, None])
        clearance = np.minimum(free, config.sight) / config.sight
        total = config.heading * (1 - off / np.pi) + config.speed * speed
        return self._kernel @ (total + config.clearance * clearance[:, None])

    def _smoothing_kernel(self) -> FloatArray:
        """Return the weights (directions, directions) with which neighbours count."""
        if not self.config.smoothing:
            return np.eye(self.config.directions)
        apart = wrap_angle(self._offsets[:, None] - self._offsets)
        weight = np.exp(-0.5 * (apart / self.config.smoothing) ** 2)
        return weight / weight.sum(axis=1, keepdims=True)
