"""Specs with a row for each world."""

import numpy as np
from dm_env import specs


def stacked(spec: specs.Array, count: int) -> specs.Array:
    """Return the spec of `count` arrays of a spec, stacked."""
    shape = (count, *spec.shape)
    if isinstance(spec, specs.BoundedArray):
        low, high = (np.broadcast_to(limit, shape) for limit in (spec.minimum, spec.maximum))
        return specs.BoundedArray(shape, spec.dtype, low, high, name=spec.name)
    return specs.Array(shape, spec.dtype, name=spec.name)
