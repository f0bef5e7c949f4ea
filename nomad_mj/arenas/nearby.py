"""Simulate of a large room what is near the robot only: the rest costs time and meets nothing."""

import mujoco
import numpy as np

from nomad_mj.arenas.standing import most_near, rectangles, standing
from nomad_mj.types import IntArray

FEWEST = 60
"""Rooms in which no more geoms than this stand are simulated as they are."""

SLACK = 0.5
"""How far the robot goes before it is seen to again what is near [m]."""

_STEP = 0.5  # [m] that it may be farther when it is seen to: 10 m/s
_SLOT = "near/"
_OWN = {"geom_bodyid", "geom_plugin", "geom_user"}  # a slot's own, or nothing that is simulated


def near_model(spec: mujoco.MjSpec, model: mujoco.MjModel, reach: float) -> mujoco.MjModel | None:
    """Return a model with slots, for `Nearby`, in place of all that stands; None if that is no use.

    Parameters
    ----------
    spec : mujoco.MjSpec
        What `model` was compiled from; it is changed.
    model : mujoco.MjModel
        Robot and room, whole.
    reach : float
        From the robot's centre to the far end of its longest ray [m].
    """
    geoms = standing(model)
    # What moves beside the robot may fall or roll into what is far from the robot.
    if model.ntree > 1 or not np.isfinite(reach) or len(geoms) <= FEWEST:
        return None
    slots = most_near(*rectangles(model, geoms), _within(reach))
    if slots >= len(geoms):
        return None
    taken = {*geoms.tolist()}
    for geom in [geom for geom in spec.geoms if geom.id in taken]:
        spec.delete(geom)
    for slot in range(slots):
        spec.worldbody.add_geom(
            name=f"{_SLOT}{slot}",
            size=[0.1, 0.1, 0.1],
            margin=float(model.geom_margin[geoms].max()),
            # What the engine notes of the whole body must hold whatever comes into the slots.
            contype=int(np.bitwise_or.reduce(model.geom_contype[geoms])),
            conaffinity=int(np.bitwise_or.reduce(model.geom_conaffinity[geoms])),
        )
    result = spec.compile()
    # The tree in which the engine looks for collisions would not follow what comes into the slots.
    result.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_MIDPHASE
    _empty(result, _slots(result))
    return result


class Nearby:
    """Keeps in the slots of a model what is near a robot, as it drives.

    The engine tests every ray against every geom, however far it is, and computes in every step
    where each of them is. The model that is simulated of a large room has so many slots for geoms
    as can be near at once. What stands farther from the robot than its rays reach is not in it;
    what the rays read within their reach does not change.

    Parameters
    ----------
    whole : mujoco.MjModel
        With all there is.
    model : mujoco.MjModel
        Its `near_model`, which is simulated; changed in place.
    reach : float
        What `near_model` was given.

    Attributes
    ----------
    held : ndarray of int, shape (H,)
        The geoms of `whole` that are in the slots now, in their order.
    """

    def __init__(self, whole: mujoco.MjModel, model: mujoco.MjModel, reach: float) -> None:
        self._model = model
        self._within = _within(reach)
        self._standing = standing(whole)
        self._middle, self._half = rectangles(whole, self._standing)
        self._slots = _slots(model)
        self._fields = _fields(whole, model, self._standing)
        self._last = (np.inf, np.inf)
        self.held = np.zeros(0, dtype=np.intp)

    def update(self, x: float, y: float) -> bool:
        """See to it that all is there that a robot at x, y [m] or its rays can meet.

        Returns
        -------
        bool
            Whether the model was changed.
        """
        last_x, last_y = self._last
        if abs(x - last_x) + abs(y - last_y) < SLACK:
            return False
        gap = np.maximum(np.abs(self._middle - (x, y)) - self._half, 0.0)
        near = np.flatnonzero(gap[:, 0] ** 2 + gap[:, 1] ** 2 <= self._within**2)
        slots, others = self._slots[: len(near)], self._slots[len(near) :]
        for field, values in self._fields:
            field[slots] = values[near]
        _empty(self._model, others)
        self._last = x, y
        self.held = self._standing[near]
        return True


def _within(reach: float) -> float:
    """Return how near something is held [m]."""
    return reach + SLACK + _STEP


def _slots(model: mujoco.MjModel) -> IntArray:
    """Return the geoms of a model that are slots, (S,)."""
    names = [model.geom(geom).name for geom in range(model.ngeom)]
    return np.flatnonzero([name.startswith(_SLOT) for name in names])


def _empty(model: mujoco.MjModel, slots: IntArray) -> None:
    """Let slots hold nothing that a robot or a ray could meet."""
    model.geom_contype[slots] = model.geom_conaffinity[slots] = 0
    model.geom_rgba[slots, 3] = 0.0
    model.geom_matid[slots] = -1  # or the material's colour would count


def _fields(
    whole: mujoco.MjModel, model: mujoco.MjModel, geoms: IntArray
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return all the engine has about geoms: its arrays in `model`, their values (N, ...) here."""
    names = [name for name in dir(whole) if name.startswith("geom_") and name not in _OWN]
    values = {name: getattr(whole, name)[geoms] for name in names}
    data = mujoco.MjData(whole)
    mujoco.mj_kinematics(whole, data)
    on_body = np.flatnonzero(whole.geom_bodyid[geoms])
    values["geom_sameframe"][on_body] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE
    values["geom_pos"][on_body] = data.geom_xpos[geoms[on_body]]
    for row in on_body.tolist():
        turned = data.xquat[whole.geom_bodyid[geoms[row]]]
        mujoco.mju_mulQuat(values["geom_quat"][row], turned, whole.geom_quat[geoms[row]])
    return [(getattr(model, name), values[name]) for name in names]
