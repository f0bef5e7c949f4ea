"""One of many worlds, seen as a simulation of its own."""

from nomad_mj.batch.lot import Moved
from nomad_mj.batch.simulations import Simulations
from nomad_mj.types import FloatArray, IntArray, Pose


class World:
    """One world, as its task asks for it.

    Parameters
    ----------
    number : int
        Which.
    simulations : Simulations
        Of all worlds.
    moved : Moved
        Where it notes what moves in the step to come.
    touched : array (B,)
        Its bumpers as they are, kept up to date by `Worlds`.
    """

    def __init__(
        self, number: int, simulations: Simulations, moved: Moved, touched: FloatArray
    ) -> None:
        self._number, self._simulations, self._moved = number, simulations, moved
        self._touched = touched

    def pose(self) -> Pose:
        """Return the true pose of the robot."""
        return self._simulations.pose(self._number)

    def bumpers(self) -> FloatArray:
        """Return 1 for each bumper touched in the last control step, else 0, (B,)."""
        return self._touched.copy()

    def move_bodies(self, rows: IntArray, places: FloatArray) -> None:
        """Put mocap bodies, given their rows (n,), at places (n, 2) [m], in the step to come."""
        self._moved[self._number] = rows, places
