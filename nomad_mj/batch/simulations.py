"""All worlds' simulations, on so many threads: lots of equal models, side by side."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
from dm_control.rl.control import PhysicsError

from nomad_mj.batch.lot import Lot, Moved, Sensed
from nomad_mj.scene import Scene
from nomad_mj.tasks import MotorConfig, NavigationPhysics
from nomad_mj.types import FloatArray, IntArray, Pose


class Simulations:
    """N worlds, each a scene with a robot.

    The engine steps models of one size together, on threads of its own. Rooms of several sizes
    make several lots, which are stepped at the same time.

    Parameters
    ----------
    scenes : list of Scene, length N
        One a world; the same one may be there often.
    config : MotorConfig
        For what the physics has to know of the sensors.
    threads : int
        To run on.
    """

    def __init__(self, scenes: list[Scene], config: MotorConfig, threads: int) -> None:
        groups = _groups(scenes)
        self._lots = [
            Lot(
                np.array(worlds, dtype=np.intp),
                [scenes[world] for world in worlds],
                config,
                max(round(threads * len(worlds) / len(scenes)), 1),
            )
            for worlds in groups
        ]
        self._where = {
            world: (lot, row)
            for lot, worlds in zip(self._lots, groups, strict=True)
            for row, world in enumerate(worlds)
        }
        count = min(threads, len(groups))
        self._pool = ThreadPoolExecutor(count) if count > 1 else None

    def take(self, world: int, physics: NavigationPhysics) -> None:
        """Let a world go on from the state of another simulation of its scene."""
        lot, row = self._where[world]
        lot.take(row, physics)

    def step(self, worlds: IntArray, commands: FloatArray, moved: Moved) -> None:
        """Advance worlds (n,), ascending, by a control step, given their commands (n, M).

        Parameters
        ----------
        worlds, commands
            As of `Lot.step`, by the numbers of the worlds.
        moved : Moved
            By world; that of others is left alone.

        Raises
        ------
        PhysicsError
            Naming the worlds that diverged. All have been stepped then, and none still is.
        """
        jobs = [
            partial(lot.step, rows, commands[chosen], _own(moved, lot, rows))
            for lot, chosen, rows in self._parts(worlds)
        ]
        if self._pool is None:
            errors = [_error_of(job) for job in jobs]
        else:
            errors = list(self._pool.map(_error_of, jobs))
        failed = [str(error) for error in errors if error is not None]
        if failed:
            raise PhysicsError("; ".join(failed))

    def read(self, worlds: IntArray) -> Sensed:
        """Return what the sensors of worlds (n,), ascending, read now."""
        parts = self._parts(worlds)
        read = [lot.read(rows) for lot, _, rows in parts]
        if len(read) == 1:
            return read[0]
        whole = [np.empty((len(worlds), array.shape[1])) for array in read[0]]
        for (_, chosen, _), arrays in zip(parts, read, strict=True):
            for into, array in zip(whole, arrays, strict=True):
                into[chosen] = array
        return Sensed(*whole)

    def places(self, worlds: IntArray) -> FloatArray:
        """Return where the robots of worlds (n,), ascending, truly are, (n, 2) [m]."""
        parts = self._parts(worlds)
        if len(parts) == 1:
            return parts[0][0].places(parts[0][2])
        result = np.empty((len(worlds), 2))
        for lot, chosen, rows in parts:
            result[chosen] = lot.places(rows)
        return result

    def pose(self, world: int) -> Pose:
        """Return the true pose of a world's robot."""
        lot, row = self._where[world]
        return lot.pose(row)

    def close(self) -> None:
        """Free all simulations."""
        if self._pool is not None:
            self._pool.shutdown()
        self._lots.clear()
        self._where.clear()

    def _parts(self, worlds: IntArray) -> list[tuple[Lot, IntArray | slice, IntArray]]:
        """Return lots with where their worlds are among these, and their rows."""
        if len(self._lots) == 1:
            return [(self._lots[0], slice(None), worlds)]
        parts: list[tuple[Lot, IntArray | slice, IntArray]] = []
        for lot in self._lots:
            _, chosen, rows = np.intersect1d(
                worlds, lot.worlds, assume_unique=True, return_indices=True
            )
            if len(rows):
                parts.append((lot, chosen, rows))
        return parts


def _error_of(job: Callable[[], None]) -> PhysicsError | None:
    """Do a job; return how the simulation failed, None if it did not."""
    try:
        job()
    except PhysicsError as error:
        return error
    return None


def _own(moved: Moved, lot: Lot, rows: IntArray) -> Moved:
    """Return what has moved in worlds of a lot, by their rows."""
    if not moved:
        return moved
    pairs = zip(rows.tolist(), lot.worlds[rows].tolist(), strict=True)
    return {row: moved[world] for row, world in pairs if world in moved}


def _groups(scenes: list[Scene]) -> list[list[int]]:
    """Return the worlds whose scenes go together."""
    groups: list[tuple[Scene, list[int]]] = []
    known: dict[int, list[int]] = {}
    for world, scene in enumerate(scenes):
        if id(scene) not in known:
            for first, worlds in groups:
                if Lot.fits(first, scene):
                    known[id(scene)] = worlds
                    break
            else:
                known[id(scene)] = []
                groups.append((scene, known[id(scene)]))
        known[id(scene)].append(world)
    return [worlds for _, worlds in groups]
