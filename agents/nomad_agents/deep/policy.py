"""The network that acts, in plain numpy: what is left of a deep learner when it has learnt."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

Float32Array: TypeAlias = npt.NDArray[np.float32]
Activation = Literal["relu", "tanh"]
Bound = Literal["tanh", "clip"]


@dataclass(frozen=True)
class Policy:
    """A multilayer perceptron from an observation to the action it would take without exploring.

    Attributes
    ----------
    weights : tuple of array (outputs, inputs)
        Of each layer, float32.
    biases : tuple of array (outputs,)
        Of each layer, float32.
    hidden : "relu" or "tanh"
        Activation of all layers but the last.
    bound : "tanh" or "clip"
        How the last layer is brought into [-1, 1].

    Raises
    ------
    ValueError
        Layers that do not follow on each other, that are not float32 or not finite.
    """

    weights: tuple[Float32Array, ...]
    biases: tuple[Float32Array, ...]
    hidden: Activation
    bound: Bound

    def __post_init__(self) -> None:
        if not self.weights or len(self.weights) != len(self.biases):
            raise ValueError(f"{len(self.weights)} layers of weights, {len(self.biases)} of biases")
        inputs = self.weights[0].shape[-1:]
        for weight, bias in zip(self.weights, self.biases, strict=True):
            if weight.ndim != 2 or weight.shape[1:] != inputs or bias.shape != weight.shape[:1]:
                raise ValueError(f"a layer of {weight.shape} and {bias.shape} after {inputs}")
            if weight.dtype != np.float32 or bias.dtype != np.float32:
                raise ValueError(f"a layer of {weight.dtype} and {bias.dtype}, not float32")
            if not (np.isfinite(weight).all() and np.isfinite(bias).all()):
                raise ValueError("a layer that is not finite")
            inputs = bias.shape
        if self.hidden not in ("relu", "tanh") or self.bound not in ("tanh", "clip"):
            raise ValueError(
                f"an activation {self.hidden!r} or a bound {self.bound!r} unknown here"
            )

    @property
    def inputs(self) -> int:
        """Number of components of an observation."""
        return self.weights[0].shape[1]

    @property
    def outputs(self) -> int:
        """Number of components of an action."""
        return len(self.biases[-1])

    def __call__(self, observation: Float32Array) -> Float32Array:
        """Return the action (..., outputs) in [-1, 1] for an observation (..., inputs)."""
        signal = observation.astype(np.float32, copy=False)
        for weight, bias in zip(self.weights[:-1], self.biases[:-1], strict=True):
            signal = signal @ weight.T + bias
            signal = np.maximum(signal, 0) if self.hidden == "relu" else np.tanh(signal)
        signal = signal @ self.weights[-1].T + self.biases[-1]
        return np.tanh(signal) if self.bound == "tanh" else np.clip(signal, -1.0, 1.0)

    def arrays(self) -> dict[str, Float32Array]:
        """Return the layers by name, for a file; `policy_from` takes them back."""
        named: dict[str, Float32Array] = {}
        for number, (weight, bias) in enumerate(zip(self.weights, self.biases, strict=True)):
            named |= {f"weight_{number}": weight, f"bias_{number}": bias}
        return named


def policy_from(arrays: Mapping[str, Float32Array], hidden: Activation, bound: Bound) -> Policy:
    """Return the policy of arrays named as by `Policy.arrays`; ValueError if they are others."""
    layers = range(len(arrays) // 2)
    names = {f"{kind}_{number}" for kind in ("weight", "bias") for number in layers}
    if set(arrays) != names:
        raise ValueError(f"arrays {sorted(arrays)} are not the layers of a network")
    weights = tuple(arrays[f"weight_{number}"] for number in layers)
    return Policy(weights, tuple(arrays[f"bias_{number}"] for number in layers), hidden, bound)
