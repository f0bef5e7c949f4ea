"""Specs with a row for each world."""

import numpy as np
from dm_env import specs


def stacked(spec: specs.Array, count: int) -> specs.Array:
    """Return the spec of `count` arrays of a spec, stacked."""
    if isinstance(spec, specs.BoundedArray):
        return stacked_bounded(spec, count)
    return specs.Array((count, *spec.shape), spec.dtype, name=spec.name)


def stacked_bounded(spec: specs.BoundedArray, count: int) -> specs.BoundedArray:
    """Return the spec of `count` arrays with limits, stacked."""
    shape = (count, *spec.shape)
    low, high = (np.broadcast_to(limit, shape) for limit in (spec.minimum, spec.maximum))
    return specs.BoundedArray(shape, spec.dtype, low, high, name=spec.name)
