"""Elements of the robot in a compiled scene, found by name; what is missing is named."""

import mujoco
import numpy as np

from nomad_mj.errors import ModelError

PREFIX = "robot/"  # of everything that belongs to the robot in a compiled scene


class NamedModel:
    """The robot's part of a compiled scene: names without the prefix.

    Parameters
    ----------
    model : mujoco.MjModel
        The scene.
    robot : str
        The robot's name, for messages.
    """

    def __init__(self, model: mujoco.MjModel, robot: str) -> None:
        self.model, self.robot = model, robot
        self._numbers = self.names(mujoco.mjtObj.mjOBJ_NUMERIC, model.nnumeric)
        self._texts = self.names(mujoco.mjtObj.mjOBJ_TEXT, model.ntext)

    def names(self, kind: mujoco.mjtObj, count: int) -> dict[str, int]:
        """Return the indices of the robot's named elements of a kind."""
        found = [(mujoco.mj_id2name(self.model, kind, i) or "", i) for i in range(count)]
        return {name.removeprefix(PREFIX): i for name, i in found if name.startswith(PREFIX)}

    def actuators(self) -> dict[str, int]:
        """Return the indices of the named actuators."""
        return self.names(mujoco.mjtObj.mjOBJ_ACTUATOR, self.model.nactuator)

    def bodies(self) -> dict[str, int]:
        """Return the indices of the bodies."""
        return self.names(mujoco.mjtObj.mjOBJ_BODY, self.model.nbody)

    def error(self, message: str) -> ModelError:
        """Return an error about this robot."""
        return ModelError(f"robot {self.robot!r}{message}")

    def require(self, what: str, name: str, there: dict[str, int]) -> int:
        """Return the index of an element; raise a ModelError that lists what there is."""
        if name in there:
            return there[name]
        listed = ", ".join(list(there)[:12]) + (", ..." if len(there) > 12 else "")
        raise self.error(f" lacks the {what} {name!r}; {what}s it has: {listed or 'none'}")

    def find_number(self, name: str) -> float | None:
        """Return a custom number, None if there is none; it must be above 0."""
        index = self._numbers.get(name)
        if index is None:
            return None
        value = float(self.model.numeric_data[self.model.numeric_adr[index]])
        if not 0 < value < np.inf:
            raise self.error(f": its {name} is {value:g}; it must be above 0")
        return value

    def number(self, name: str, default: float) -> float:
        """Return a custom number, above 0 or the default."""
        index = self._numbers.get(name)
        if index is not None and self.model.numeric_data[self.model.numeric_adr[index]] == default:
            return default
        return self.find_number(name) or default

    def any_number(self, name: str) -> float:
        """Return a custom number of any sign, 0 if there is none."""
        index = self._numbers.get(name)
        return (
            0.0 if index is None else float(self.model.numeric_data[self.model.numeric_adr[index]])
        )

    def text(self, name: str) -> str:
        """Return a custom text, empty if there is none."""
        index = self._texts.get(name)
        if index is None:
            return ""
        first = self.model.text_adr[index]
        raw = self.model.text_data[first : first + self.model.text_size[index]]
        return bytes(raw).rstrip(b"\0").decode("utf-8", "replace")
