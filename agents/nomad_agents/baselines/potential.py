"""The virtual force field: potential fields on a certainty grid.

Source: J. Borenstein, Y. Koren, "Real-time obstacle avoidance for fast mobile robots", IEEE
Transactions on Systems, Man, and Cybernetics 19 (1989), reference 11 of the learning paper.

Every occupied cell pushes the robot away, by its certainty and the inverse square of its distance;
the goal pulls with a constant force; the robot drives along the sum. The authors damp what would
make it swing: a cell pushes less the less the robot drives at it. Where the force turns it away
from the goal by more than a right angle, it is about to be trapped in a local minimum, and follows
the wall until the goal is ahead again: the goal's pull gives way to one along and into the wall,
against which the wall's push keeps the robot at its distance.

What is adapted, and why:

- The authors steer some ten times a second while the robot drives. Here a decision is a move, so
  it is short where forces act on the robot: the more so the more squarely they oppose it, as the
  authors slow down, and never into what the grid shows in its way.
- Along a wall the push is not damped: that would vary with each move, and the robot would weave.
- Their grid adds up readings as the robot drives. Here it is that of one round of readings.
- The authors leave the wall when the robot faces the goal again. Here that would lead it back into
  the trap with the next move, so it must also have come nearer to the goal than it was there.
- What is farther than the goal does not push, or a goal before a wall is never reached.

Narrow passages push back with all of their walls: what the method is known for (J. Borenstein,
Y. Koren, "Potential field methods and their inherent limitations", ICRA 1991) is not mended.
"""

from dataclasses import dataclass

import numpy as np

from nomad_agents.baselines.classical import BLOCKED, NEAR, ClassicalAgent
from nomad_agents.baselines.way import centres, free_way
from nomad_agents.reactive_planner.config import ReactivePlannerConfig
from nomad_mj.geometry import direction, rotate, wrap_angle
from nomad_mj.limits import require
from nomad_mj.perception import Percept
from nomad_mj.types import FloatArray, SensorLayout

_FAN: FloatArray = np.deg2rad(
    [s * d for d in range(0, 181, 5) for s in ((1, -1) if d % 180 else (1,))]
)


@dataclass(frozen=True)
class PotentialConfig:
    """Settings of the virtual force field; the goal's pull is 1.

    Attributes
    ----------
    repulsion : float
        Force of a certain cell at a metre from the robot's perimeter.
    near : float
        Cells push as if no nearer than this to the robot's perimeter [m].
    window : float
        Cells farther than this from the robot's perimeter [m] do not push.
    damping : float
        w: the share of its force with which a cell pushes that the robot does not drive at.
    slowest : float
        Moves are at least so long where forces act [m].
    follow : float
        alpha: along a wall the pull is not the goal's, but so far from the direction in which the
        wall pushes [rad], partly into it: push and pull balance at some distance from the wall.
        0: it does not follow walls.
    safety : float
        Distance to keep from the centres of occupied cells, beside the robot's radius [m].
    occupied : float
        Above this probability a cell pushes; what nothing sees does not.
    """

    repulsion: float = 0.03
    near: float = 0.1
    window: float = 1.0
    damping: float = 0.5
    slowest: float = 0.2
    follow: float = np.deg2rad(145)
    safety: float = 0.2
    occupied: float = 0.5

    def __post_init__(self) -> None:
        require(
            self,
            repulsion=(0, np.inf),
            near=(0.001, np.inf),
            window=(0.01, np.inf),
            damping=(0, 1),
            slowest=(0, np.inf),
            follow=(0, np.pi),
            safety=(0, np.inf),
            occupied=(0, 1),
        )


class PotentialField(ClassicalAgent[PotentialConfig]):
    """Drives along the sum of forces; remembers its last direction and which wall it follows."""

    name = "potential"

    def __init__(
        self,
        layout: SensorLayout,
        config: ReactivePlannerConfig,
        field: PotentialConfig | None = None,
    ) -> None:
        super().__init__(layout, config, field or PotentialConfig())
        cells = centres(config.situation.grid)
        self._distance = np.hypot(cells[:, 0], cells[:, 1])
        # Unit vectors from each cell to the robot, and the push of a certain one, (cells**2, 2).
        self._away = -cells / np.maximum(self._distance, NEAR)[:, None]
        gap = self._distance - layout.radius
        strength = self.config.repulsion / np.maximum(gap, self.config.near) ** 2
        self._push = self._away * (strength * (gap <= self.config.window))[:, None]
        self.start_episode()

    def start_episode(self, chance: np.random.Generator | None = None) -> None:
        """Forget the last direction and the wall that was followed."""
        super().start_episode(chance)
        self._side = 0  # to which it turns from the wall's push: 1 left, -1 right, 0 no wall
        self._trapped_at = np.inf  # distance to the goal where it began to follow a wall [m]

    def _choose(self, percept: Percept, longest: float) -> tuple[float, float]:
        """Return the move along the force."""
        goal = percept.goal
        ahead = float(direction(goal))
        push, raw = self._repulsion(percept, ahead if self._last is None else self._last)
        heading = self._steer(goal, push, raw)
        heading, free = _clear(heading, self._occupied(percept), self._reach)
        length = self._length(heading, raw, longest)
        return heading, min(length, max(free, BLOCKED))

    def _repulsion(self, percept: Percept, heading: float) -> tuple[FloatArray, FloatArray]:
        """Return the sum of all pushes (2,), damped, for a robot that drives so, and undamped."""
        config, certainty = self.config, percept.grid.ravel()
        near = self._distance <= np.hypot(percept.goal[0], percept.goal[1]) + self._reach
        certainty = np.where(near & (certainty > config.occupied), certainty, 0.0)
        raw = certainty @ self._push
        facing = -self._away @ np.array([np.cos(heading), np.sin(heading)])
        damped = config.damping + (1 - config.damping) * np.maximum(facing, 0.0)
        return (certainty * damped) @ self._push, raw

    def _steer(self, goal: FloatArray, push: FloatArray, raw: FloatArray) -> float:
        """Return where to head [rad]: along the force, or along a wall where that leads back."""
        pull = goal / np.hypot(goal[0], goal[1])
        force = float(direction(pull + push))
        if not self.config.follow or not raw.any():
            self._side = 0
            return force
        ahead, distance = float(direction(goal)), float(np.hypot(goal[0], goal[1]))
        back = abs(float(wrap_angle(force - ahead))) > np.pi / 2
        if self._side and not back and distance < self._trapped_at:
            self._side = 0
        pushed = float(direction(raw))
        if not self._side and back:
            self._trapped_at = distance
            before = ahead if self._last is None else self._last
            self._side = 1 if float(wrap_angle(before - pushed)) >= 0 else -1
        if not self._side:
            return force
        along = pushed + self._side * self.config.follow
        return float(direction(np.array([np.cos(along), np.sin(along)]) + raw))

    def _length(self, heading: float, push: FloatArray, longest: float) -> float:
        """Return how far to go [m]: the less, the more squarely the push opposes or aids it."""
        size = float(np.hypot(push[0], push[1]))
        if not size:
            return longest
        along = abs(float(rotate(push, -heading)[0])) / size
        return min(max(self.action.longest * (1 - along), self.config.slowest), longest)


def _clear(heading: float, cells: FloatArray, reach: float) -> tuple[float, float]:
    """Return the direction nearest to this one that leads anywhere, and how far it is free [m].

    Of two that are equally near, to the left and to the right, the freer one.
    """
    headings = wrap_angle(heading + _FAN)
    free = free_way(headings, cells, reach)
    open_ways = free >= min(BLOCKED, free.max())
    best = int(np.lexsort((-free, np.abs(_FAN), ~open_ways))[0])
    return float(headings[best]), float(free[best])
