"""Hide from rays what stands beyond their reach: in a large room most of what they would test."""

import mujoco
import numpy as np

from nomad_mj.types import FloatArray

FEWEST = 60
"""In rooms with no more geoms than this, hiding costs more than it saves."""

SLACK = 0.5
"""How far the robot goes before it is seen to again what is near [m]."""

_STEP = 0.1  # [m] that it may be farther when it is seen to


class Nearby:
    """Which walls and obstacles the rays of a robot can meet, kept up to date as it drives.

    The engine tests every ray against every geom, however far it is: 8 ns a box and ray, and 1 ns
    if the box is invisible. All that stands farther from the robot than its rays reach is
    therefore made invisible in the model that is simulated; what the rays read within their reach
    does not change. Contacts do not look at colours.

    Parameters
    ----------
    model : mujoco.MjModel
        The model that is simulated, all visible; it is changed in place, so draw another.
    reach : float
        From the robot's centre to the far end of its longest ray [m]; infinite hides nothing.

    Attributes
    ----------
    useful : bool
        Whether there is enough to hide.
    hidden : ndarray of int, shape (H,)
        The geoms that are hidden now.
    """

    def __init__(self, model: mujoco.MjModel, reach: float) -> None:
        self._model = model
        self._reach = reach + SLACK + _STEP
        self._standing = np.flatnonzero(_stands(model))
        self._middle, self._half = _boxes(model, self._standing)
        self._alpha = model.geom_rgba[:, 3].copy()
        self._material = model.geom_matid.copy()
        self.useful = np.isfinite(reach) and len(self._standing) > FEWEST
        self._last = (np.inf, np.inf)
        self.hidden = np.zeros(0, dtype=np.intp)

    @staticmethod
    def may_help(model: mujoco.MjModel) -> bool:
        """Return whether there may be enough to hide in a model."""
        return int(model.ngeom) > FEWEST

    def update(self, x: float, y: float) -> None:
        """See to it that all is visible that the rays of a robot at x, y [m] can meet."""
        last_x, last_y = self._last
        if not self.useful or abs(x - last_x) + abs(y - last_y) < SLACK:
            return
        gap = np.maximum(np.abs(self._middle - (x, y)) - self._half, 0.0)
        far = gap[:, 0] ** 2 + gap[:, 1] ** 2 > self._reach**2
        self.show_all()
        self._last = x, y
        self.hidden = self._standing[far]
        self._model.geom_rgba[self.hidden, 3] = 0.0
        self._model.geom_matid[self.hidden] = -1  # or the material's colour would count

    def show_all(self) -> None:
        """Let all be visible again, for a picture; the next `update` hides."""
        self._model.geom_rgba[self.hidden, 3] = self._alpha[self.hidden]
        self._model.geom_matid[self.hidden] = self._material[self.hidden]
        self.hidden = self.hidden[:0]
        self._last = (np.inf, np.inf)


def _stands(model: mujoco.MjModel) -> np.ndarray:
    """Whether each geom stands still and has an end: (G,)."""
    fixed = (model.body_weldid == 0) & (model.body_mocapid[model.body_rootid] < 0)
    return fixed[model.geom_bodyid] & (model.geom_type != mujoco.mjtGeom.mjGEOM_PLANE)


def _boxes(model: mujoco.MjModel, geoms: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """Return middle and half sides, (N, 2) [m], of rectangles around geoms that stand."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    rotation = data.geom_xmat[geoms].reshape(-1, 3, 3)[:, :2]
    local, half = model.geom_aabb[geoms, :3], model.geom_aabb[geoms, 3:]
    middle = data.geom_xpos[geoms, :2] + np.einsum("nij,nj->ni", rotation, local)
    return middle, np.einsum("nij,nj->ni", np.abs(rotation), half)
