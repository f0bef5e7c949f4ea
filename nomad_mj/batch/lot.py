"""Worlds whose models are of one size: they share an engine's batch."""

from typing import NamedTuple

import mujoco
import numpy as np
from dm_control.rl.control import PhysicsError
from mujoco.batch import Batch, SimulationError

from nomad_mj.arenas import Nearby
from nomad_mj.scene import CONTROL_TIMESTEP, Scene
from nomad_mj.tasks import MotorConfig, NavigationPhysics
from nomad_mj.tasks.infrared import Infrared
from nomad_mj.tasks.readout import Readout
from nomad_mj.types import FloatArray, IntArray, Pose

Moved = dict[int, tuple[IntArray, FloatArray]]
"""Mocap bodies that move (k,), and where to (k, 2) [m], by the world or its row in a lot."""

_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
_CURRENT = mujoco.mjtStage.mjSTAGE_VEL.value  # positions, velocities and what is sensed of them


class Sensed(NamedTuple):
    """What the sensors of n worlds read, before anything errs.

    Attributes
    ----------
    cones : array (n, C)
        Each cone's shortest ray from the perimeter [m].
    bumpers : array (n, B)
        1 for each bumper touched in the control step.
    encoders : array (n, E)
        Ways in the control step [m], then angles [rad].
    """

    cones: FloatArray
    bumpers: FloatArray
    encoders: FloatArray


class Lot:
    """The simulations of some worlds, stepped together.

    Parameters
    ----------
    worlds : array (n,)
        Their numbers, ascending.
    scenes : list of Scene, length n
        Theirs; `fits` tells which go together.
    config : MotorConfig
        For what the physics has to know of the sensors.
    threads : int
        To step them on.
    """

    def __init__(
        self, worlds: IntArray, scenes: list[Scene], config: MotorConfig, threads: int
    ) -> None:
        self.worlds = worlds
        self._models = [scene.simulated() for scene in scenes]
        self._near = {
            row: Nearby(scene.model, model, scene.robot.reach)
            for row, (scene, model) in enumerate(zip(scenes, self._models, strict=True))
            if scene.near_model is not None
        }
        model, robot = self._models[0], scenes[0].robot
        self._batch = Batch(model, len(worlds), threads, persistent=True)
        self._batch.set_models(self._models)
        # Bound before the first call, or they would be zero after it.
        self._sensordata: FloatArray = self._batch.bind("sensordata")
        self._history: FloatArray = self._batch.bind("history")
        self._qpos: FloatArray = self._batch.bind("qpos")
        self._ctrl: FloatArray = self._batch.bind("ctrl")
        self._mocap_pos: FloatArray = self._batch.bind("mocap_pos")
        self._controls = robot.controls
        self._footing = robot.footing
        # History and positions lie in the rows of the state, which can be taken from as they are.
        self._readout = Readout.of(model, robot).moved(
            history=_offset(self._batch.state, self._history),
            qpos=_offset(self._batch.state, self._qpos),
        )
        self._sub_steps = round(CONTROL_TIMESTEP / model.opt.timestep)
        self._grazing = config.range_noise.grazing
        self._lights = self._infrared(config, scenes)
        self._scratch = mujoco.MjData(model)  # of one world at a time, for infrared light

    @staticmethod
    def _infrared(config: MotorConfig, scenes: list[Scene]) -> list[Infrared]:
        if config.infrared is None:
            return []
        made = {id(s): Infrared(config.infrared, s.model, s.robot) for s in scenes}
        return [made[id(scene)] for scene in scenes]

    @staticmethod
    def fits(first: Scene, other: Scene) -> bool:
        """Return whether two scenes can be in one lot: all that the engine holds is of one size."""
        if first is other:
            return True
        try:
            Batch(first.simulated(), 1, 1).set_models([other.simulated()])
        except mujoco.FatalError:  # what the engine raises for another layout
            return False
        return _addresses(first) == _addresses(other)

    def take(self, row: int, physics: NavigationPhysics) -> None:
        """Let a world go on from the state of another simulation of its model."""
        mujoco.mj_getState(physics.model.ptr, physics.data.ptr, self._batch.state[row], _STATE)
        self._batch.warning[row] = 0

    def step(self, rows: IntArray, commands: FloatArray, moved: Moved) -> None:
        """Advance worlds by a control step.

        Parameters
        ----------
        rows : array (n,)
            Which of the lot's, ascending.
        commands : array (n, M)
            Their motors' commands.
        moved : Moved
            What moves beside the robots, by row.

        Raises
        ------
        PhysicsError
            Naming the worlds that diverged.
        """
        batch, steps = self._batch, self._sub_steps
        self._see_to_near(rows)
        self._ctrl[rows[:, None], self._controls] = commands
        ids = rows.astype(np.int32) if len(rows) < len(self.worlds) else None
        try:
            if moved:
                # The robot's velocity is the present bodies' doing; the next physics step sees
                # where they have gone.
                batch.step(ids)
                for row, (bodies, places) in moved.items():
                    self._mocap_pos[row, bodies, :2] = places
                steps -= 1
            batch.step(ids, steps, _CURRENT)
        except SimulationError as error:
            worlds = self.worlds[error.ids].tolist()
            raise PhysicsError(f"{_named(worlds)}: {batch.error(int(error.ids[0]))}") from None
        self._check(rows)

    def _see_to_near(self, rows: IntArray) -> None:
        """Let the models of large rooms hold what is near the robots of rows (n,)."""
        changed = False
        for row in rows.tolist() if self._near else ():
            if row in self._near:
                changed |= self._near[row].update(*self.pose(row)[:2])
        if changed:
            self._batch.set_models(self._models)  # or the engine may not see it

    def _check(self, rows: IntArray) -> None:
        """Raise PhysicsError if the engine has warned of a world of rows (n,)."""
        counts = self._batch.warning[:, :, 1]
        if not np.count_nonzero(counts):
            return
        bad = [row for row in rows.tolist() if np.count_nonzero(counts[row])]
        if bad:
            names = [
                kind
                for kind, count in zip(mujoco.mjtWarning.__members__, counts[bad[0]], strict=False)
                if count
            ]
            time = float(self._batch.bind("time")[bad[0]])
            raise PhysicsError(
                f"{_named(self.worlds[bad].tolist())}: the simulation diverged at {time:.3f} s: "
                f"{', '.join(names)}"
            )

    def read(self, rows: IntArray) -> Sensed:
        """Return what the sensors of worlds, by their rows (n,), read now."""
        readout = self._readout
        sensordata, state = self._sensordata, self._batch.state
        if len(rows) < len(self.worlds):
            sensordata, state = sensordata[rows], state[rows]
        distances = readout.distances(sensordata, self._grazing)
        if self._lights:
            distances = distances.copy()
            for number, row in enumerate(rows.tolist()):
                self._batch.get_data(row, self._scratch)
                light, model = self._lights[row], self._models[row]
                distances[number] = light.judge(distances[number], model, self._scratch)
        return Sensed(
            readout.cones(distances),
            readout.bumpers(state),
            readout.encoders(sensordata, state, state),
        )

    def places(self, rows: IntArray) -> FloatArray:
        """Return where the robots of worlds, by their rows (n,), truly are, (n, 2) [m]."""
        return self._qpos[rows[:, None], [self._footing.x, self._footing.y]]

    def pose(self, row: int) -> Pose:
        """Return the true pose of a world's robot."""
        return self._footing.pose(self._qpos[row])


def _offset(state: FloatArray, view: FloatArray) -> int:
    """Return in which column of the state's rows a view of them begins."""
    start = view.__array_interface__["data"][0] - state.__array_interface__["data"][0]
    return int(start) // state.itemsize


def _addresses(scene: Scene) -> list[bytes]:
    """Return where all that a lot reads or writes is, to be compared."""
    readout, robot = Readout.of(scene.model, scene.robot), scene.robot
    footing = np.array([robot.footing.x, robot.footing.y, robot.footing.heading])
    arrays = (readout.rays.address, readout.touch, readout.speed_now, readout.speeds)
    return [array.tobytes() for array in (*arrays, readout.angles, robot.controls, footing)]


def _named(worlds: list[int]) -> str:
    names = ", ".join(map(str, worlds[:5])) + (", ..." if len(worlds) > 5 else "")
    return f"world{'s' if len(worlds) > 1 else ''} {names}"
