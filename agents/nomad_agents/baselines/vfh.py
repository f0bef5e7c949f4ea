"""VFH+, the vector field histogram with its improvements of 1998.

Source: I. Ulrich, J. Borenstein, "VFH+: reliable obstacle avoidance for fast mobile robots", IEEE
International Conference on Robotics and Automation (1998); the histogram is that of J. Borenstein,
Y. Koren, "The vector field histogram", IEEE Transactions on Robotics and Automation 7 (1991).

What is adapted, and why:

- The authors add up readings in their grid as the robot drives. Here the grid is that of one round
  of readings, which all sensors of the ring give at once.
- The third histogram masks directions that a robot cannot turn to because something lies in its
  curve. Our robot turns on the spot before it drives, its curve has radius 0, and the masked
  histogram is the binary one.
- The cost counts the turn from the present direction and that from the direction chosen last. The
  wheels of a robot that stands still face where it drove last: the two are the same, and
  their weights add up.
- The authors set a speed by the density ahead; here it is the length of a move, which ends before
  what the grid shows in its way.
- What is farther than the goal is left out of the histogram, or a goal before a wall is never
  reached.
"""

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from nomad_agents.baselines.classical import BLOCKED, ClassicalAgent
from nomad_agents.baselines.way import centres, free_way
from nomad_agents.reactive_planner.config import ReactivePlannerConfig
from nomad_mj.geometry import direction, wrap_angle
from nomad_mj.limits import require
from nomad_mj.perception import GridSpec, Percept
from nomad_mj.types import FloatArray, SensorLayout

_Sectors: TypeAlias = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class VfhConfig:
    """Settings of VFH+.

    Attributes
    ----------
    sectors : int
        Of the histogram; 72 are 5 degrees wide, as the paper's.
    window : float
        Cells farther than this [m] do not count: their weight falls with the squared distance to
        0 there.
    low, high : float
        Thresholds of the density, tau_low and tau_high: a sector is blocked from `high` on and
        stays so until `low`.
    wide : float
        s_max: in an opening wider than this [rad] the robot keeps half of it from either border.
    goal, current, previous : float
        Weights mu_1, mu_2 and mu_3 of the turns from the goal's, the present and the last way.
    safety : float
        Distance to keep from the centres of occupied cells, beside the robot's radius [m].
    occupied : float
        Above this probability a cell counts; what nothing sees does not.
    """

    sectors: int = 72
    window: float = 1.65
    low: float = 0.2
    high: float = 0.4
    wide: float = np.deg2rad(40)
    goal: float = 5.0
    current: float = 2.0
    previous: float = 2.0
    safety: float = 0.15
    occupied: float = 0.5

    def __post_init__(self) -> None:
        require(
            self,
            sectors=(8, 3600),
            window=(0.01, np.inf),
            low=(0, self.high),
            high=(0, np.inf),
            wide=(0, 2 * np.pi),
            goal=(0, np.inf),
            current=(0, np.inf),
            previous=(0, np.inf),
            safety=(0, np.inf),
            occupied=(0, 1),
        )


class VectorFieldHistogram(ClassicalAgent[VfhConfig]):
    """Steers for the opening of least cost; remembers what was blocked and where it went."""

    name = "vfh"

    def __init__(
        self,
        layout: SensorLayout,
        config: ReactivePlannerConfig,
        histogram: VfhConfig | None = None,
    ) -> None:
        super().__init__(layout, config, histogram or VfhConfig())
        self._width = 2 * np.pi / self.config.sectors
        self._distance, self._spread = self._tables(config.situation.grid)
        self.start_episode()

    def _tables(self, grid: GridSpec) -> tuple[FloatArray, FloatArray]:
        """Return the cells' distances (cells**2,) [m] and weights (sectors, cells**2).

        A cell counts in all sectors in which the robot, grown by the safety distance, would touch
        it: this is the enlargement of VFH+.
        """
        config, cells = self.config, centres(grid)
        distance: FloatArray = np.hypot(cells[:, 0], cells[:, 1])
        half = np.arcsin(np.minimum(self._reach / np.maximum(distance, self._reach), 1.0))
        middle = np.arange(config.sectors)[:, None] * self._width
        # A hair more, so that rounding does not tell left from right at a right angle.
        covers = np.abs(wrap_angle(middle - direction(cells))) <= half + 1e-9
        weight = np.maximum(1 - (distance / config.window) ** 2, 0.0)
        return distance, np.where(covers, weight, 0.0)

    def start_episode(self, chance: np.random.Generator | None = None) -> None:
        """Forget the sectors that were blocked and the last direction."""
        self._was_blocked = np.zeros(self.config.sectors, dtype=np.bool_)
        super().start_episode(chance)

    def _choose(self, percept: Percept, longest: float) -> tuple[float, float]:
        """Return the move through the best opening."""
        config, goal = self.config, percept.goal
        density = self._density(percept)
        held = self._was_blocked & (density > config.low)
        self._was_blocked = held | (density >= config.high)
        headings = self._candidates(~self._was_blocked, float(direction(goal)))
        cells = self._occupied(percept)
        free = free_way(headings, cells, self._reach)
        headings, free = headings[free > BLOCKED], free[free > BLOCKED]
        if len(headings):
            best = int(np.argmin(self._cost(headings, goal)))
        else:  # shut in: the emptiest of the sectors that lead anywhere, of these the freest
            headings = np.arange(config.sectors, dtype=np.float64) * self._width
            free = free_way(headings, cells, self._reach)
            density = np.where(free >= min(BLOCKED, free.max()), density, np.inf)
            way = np.where(density <= density.min() + 1e-9, np.minimum(free, longest), -np.inf)
            cost = np.where(way >= way.max() - 1e-9, self._cost(headings, goal), np.inf)
            best = int(np.argmin(cost))
        return float(headings[best]), min(max(float(free[best]), BLOCKED), longest)

    def _density(self, percept: Percept) -> FloatArray:
        """Return the primary polar histogram (sectors,)."""
        certainty = percept.grid.ravel()
        near = self._distance <= np.hypot(percept.goal[0], percept.goal[1]) + self._reach
        return self._spread @ np.where(near & (certainty > self.config.occupied), certainty**2, 0.0)

    def _candidates(self, free: _Sectors, goal: float) -> FloatArray:
        """Return the directions to choose from (n,) [rad]: of each opening, one, two or three."""
        if free.all():
            return np.array([goal])
        first = np.flatnonzero(free & ~np.roll(free, 1))  # right borders of the openings
        last = np.flatnonzero(free & ~np.roll(free, -1))
        if not len(first):
            return np.zeros(0)
        if last[0] < first[0]:  # an opening goes on where the sectors begin
            last = np.roll(last, -1)
        right = first * self._width
        size = (last - first) % len(free) * self._width  # from border to border
        wide = size > self.config.wide
        margin = np.where(wide, self.config.wide / 2, size / 2)
        past = (goal - right) % (2 * np.pi)  # of the goal, from the right border
        ahead = wide & (past >= margin) & (past <= size - margin)
        found = [right + margin, (right + size - margin)[wide], np.full(int(ahead.any()), goal)]
        return wrap_angle(np.concatenate(found))

    def _cost(self, headings: FloatArray, goal: FloatArray) -> FloatArray:
        config = self.config
        cost = config.goal * np.abs(wrap_angle(headings - direction(goal)))
        if self._last is not None:
            turn = np.abs(wrap_angle(headings - self._last))
            cost = cost + (config.current + config.previous) * turn
        return cost
