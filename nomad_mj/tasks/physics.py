"""The simulated robot, asked in its own terms: readings, encoders, pose."""

from typing import Any, Protocol

import mujoco
import numpy as np
from dm_control.mujoco import Physics, wrapper
from dm_control.rl.control import PhysicsError

from nomad_mj.arenas import Nearby
from nomad_mj.motion import SynchroDrive
from nomad_mj.robots import RobotDescription
from nomad_mj.scene import Scene
from nomad_mj.tasks.infrared import Infrared, InfraredEffects
from nomad_mj.tasks.readout import Readout, as_span
from nomad_mj.types import FloatArray, IntArray, Pose

_STATE = mujoco.mjtState.mjSTATE_INTEGRATION


class Posed(Protocol):
    """A simulation that tells where its robot is."""

    def pose(self) -> Pose:
        """Return the true pose of the robot."""
        ...


class Placeable(Posed, Protocol):
    """What a task asks of a simulation beside its sensors."""

    def move_bodies(self, rows: IntArray, places: FloatArray) -> None:
        """Put mocap bodies, given their rows (n,), at places (n, 2) [m]; the next step sees it."""
        ...


class NavigationPhysics(Physics):
    """dm_control's Physics with named questions, and a step without Python in its way."""

    robot: RobotDescription
    grazing: float | None
    infrared: Infrared | None
    whole: mujoco.MjModel | None
    """All there is, if the model that is simulated holds only what is near: see `Nearby`."""
    _near: Nearby | None = None
    _picture: Physics | None = None  # of `whole`, made when it is first asked for

    @classmethod
    def from_scene(
        cls, scene: Scene, grazing: float | None = None, infrared: InfraredEffects | None = None
    ) -> "NavigationPhysics":
        """Return a new simulation of `scene`; `grazing` as of `RangeNoise`.

        Raises
        ------
        ConfigError
            The robot lacks a ring of `infrared`.
        """
        light = Infrared(infrared, scene.model, scene.robot) if infrared is not None else None
        physics = cls.from_model(wrapper.MjModel(scene.simulated()))
        physics.robot, physics.grazing, physics.infrared = scene.robot, grazing, light
        physics.whole = scene.model if scene.near_model is not None else None
        physics._bind()
        return physics

    def _reload_from_data(self, data: Any) -> None:
        self._near = None
        super()._reload_from_data(data)
        if hasattr(self, "robot"):
            self._bind()

    def copy(self, share_model: bool = False) -> "NavigationPhysics":
        """Return an independent copy of this simulation in its present state."""
        # Two robots in different places need slots of their own.
        other: NavigationPhysics = super().copy(share_model and self.whole is None)
        other.robot, other.grazing, other.infrared = self.robot, self.grazing, self.infrared
        other.whole = self.whole
        other._bind()
        return other

    def __getstate__(self) -> Any:
        return super().__getstate__(), self.robot, self.grazing, self.infrared, self.whole

    def __setstate__(self, state: Any) -> None:
        data, self.robot, self.grazing, self.infrared, self.whole = state
        super().__setstate__(data)

    def free(self) -> None:
        """Free the simulation and its OpenGL contexts; it cannot be used any more."""
        if self._picture is not None:
            self._picture.free()
            self._picture = None
        super().free()
        for name in (
            "_raw",
            "_sensordata",
            "_history",
            "_qpos",
            "_ctrl",
            "_mocap_pos",
            "_near",
        ):  # they would keep the memory alive
            vars(self).pop(name, None)

    def _bind(self) -> None:
        """Look names up once: the control step reads plain arrays."""
        model, data = self.model.ptr, self.data.ptr
        if self.whole is not None:
            self._near = Nearby(self.whole, model, self.robot.reach)
        self._raw = (model, data)
        self._sensordata: FloatArray = data.sensordata
        self._history: FloatArray = data.history
        self._mocap_pos: FloatArray = data.mocap_pos
        self._qpos: FloatArray = data.qpos
        self._ctrl: FloatArray = data.ctrl
        self._controls = as_span(self.robot.controls)
        self._readout = Readout.of(model, self.robot)
        self._bind_steering()
        self._see_to_near()
        mujoco.mj_step1(model, data)  # dm_control has just computed a copy with its motors off

    def _bind_steering(self) -> None:
        """Look up what must follow the heading of a synchro drive when it is placed."""
        model = self._raw[0]
        heading = self.robot.footing.heading
        self._servo, self._wheels = -1, np.empty(0, dtype=np.intp)
        if isinstance(self.robot.drive, SynchroDrive):
            steer = int(np.flatnonzero(model.jnt_qposadr == heading)[0])
            self._servo = int(model.actuator_actadr[self.robot.motors[1]])
            belts = (model.eq_type == mujoco.mjtEq.mjEQ_JOINT) & (model.eq_obj2id == steer)
            self._wheels = model.jnt_qposadr[model.eq_obj1id[belts]]

    def reset(self, keyframe_id: int | None = None) -> None:
        """Set the simulation to its initial state, without computing any sensor.

        Sensors that sample at intervals keep their first sample of an episode: it must wait for
        the start pose, that is for `after_reset`.
        """
        if keyframe_id is not None:
            super().reset(keyframe_id)
        else:
            mujoco.mj_resetData(*self._raw)

    def forward(self) -> None:
        """Compute all that follows from the present state, with what is near the robot now."""
        self._see_to_near()
        super().forward()

    def _see_to_near(self) -> None:
        if self._near is not None:
            self._near.update(*self.pose()[:2])

    def step(self, nstep: int = 1) -> None:
        """Advance by `nstep` physics steps; raise PhysicsError if the simulation diverges."""
        model, data = self._raw
        self._see_to_near()
        mujoco.mj_step2(model, data)
        if nstep > 1:
            mujoco.mj_step(model, data, nstep - 1)
        mujoco.mj_step1(model, data)
        if np.count_nonzero(self._warnings):
            kinds = list(mujoco.mjtWarning.__members__)
            names = [kind for kind, count in zip(kinds, self._warnings, strict=False) if count]
            raise PhysicsError(f"the simulation diverged at {data.time:.3f} s: {', '.join(names)}")

    def command(self, speeds: Any) -> None:
        """Set the motors, in the order of the drive's, to speeds [m/s], [rad/s] (or angles)."""
        self._ctrl[self._controls] = speeds

    def place(self, pose: Pose) -> None:
        """Put the robot at `pose`; a turret looks along +x."""
        self.robot.footing.place(self.data.qpos, pose)
        self.data.qpos[self._wheels] = pose.heading  # else their belts would wrench them there
        if self._servo >= 0:  # else the servo would turn the wheels back to zero
            self.data.act[self._servo] = pose.heading

    def render(self, *args: Any, **kwargs: Any) -> Any:
        """Draw all there is, however far; arguments as of dm_control's."""
        if self.whole is None:
            return super().render(*args, **kwargs)
        if self._picture is None:
            self._picture = Physics.from_model(wrapper.MjModel(self.whole))
        model, data = self._picture.model.ptr, self._picture.data.ptr
        state = np.empty(mujoco.mj_stateSize(model, _STATE))
        mujoco.mj_getState(*self._raw, state, _STATE)
        mujoco.mj_setState(model, data, state, _STATE)
        self._picture.forward()
        return self._picture.render(*args, **kwargs)

    def move_bodies(self, rows: IntArray, places: FloatArray) -> None:
        """Put mocap bodies, given their rows (n,), at places (n, 2) [m]; the next step sees it."""
        self._mocap_pos[rows, :2] = places

    def cone_ranges(self) -> FloatArray:
        """Return each cone's shortest ray, (C,) [m] from the perimeter; far beyond it: none.

        Rays of specular rings whose echo is lost count as a miss, see `RangeNoise.grazing`; those
        of infrared rings are as long as the light makes them seem, see `InfraredEffects`.
        """
        distances = self._readout.distances(self._sensordata, self.grazing)
        if self.infrared is not None:
            distances = self.infrared.judge(distances, *self._raw)
        return self._readout.cones(distances)

    def bumpers(self) -> FloatArray:
        """Return 1 for each bumper touched since the last control step, else 0, (B,)."""
        return self._readout.bumpers(self._history)

    def encoders(self) -> FloatArray:
        """Return what the encoders read: ways since the last control step [m], angles [rad]."""
        return self._readout.encoders(self._sensordata, self._history, self._qpos)

    def pose(self) -> Pose:
        """Return the true pose: where the base is and where it, or its wheels, point."""
        return self.robot.footing.pose(self._qpos)
