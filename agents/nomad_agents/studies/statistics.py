"""What is said of one number over many runs: quartiles, and the interquartile mean with bounds.

The interquartile mean (IQM) is the mean of the middle half: a lucky or an unlucky run does not move
it, and it needs fewer runs than the median to be known as well (Agarwal et al. 2021). Of less than
four runs nothing is cut: it is their mean, and the interval too narrow.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from nomad_mj.types import FloatArray

CONFIDENCE = 0.95
_RESAMPLES = 10_000
_BATCH = 1_000
_CUT = 0.25  # at either end


class Spread(NamedTuple):
    """How a number spreads over runs.

    Attributes
    ----------
    count : int
        Runs that have the number; all else is NaN where none has.
    q1, median, q3 : float
        Quartiles.
    iqm, low, high : float
        Interquartile mean and the bounds of its 95 % confidence interval. A single run says nothing
        of others: its bounds are NaN.
    """

    count: int
    q1: float
    median: float
    q3: float
    iqm: float
    low: float
    high: float


def spread(strata: Sequence[FloatArray]) -> Spread:
    """Return how a number spreads over runs.

    Parameters
    ----------
    strata : sequence of arrays (runs,)
        The number in each run, NaN where it has none; one array for each case, in which the
        bootstrap draws as many runs as there are.
    """
    from scipy.stats import trim_mean  # takes a second, which no worker and no --help need wait for

    finite = [values[np.isfinite(values)] for values in strata]
    finite = [values for values in finite if len(values)]
    if not finite:
        return Spread(0, *[np.nan] * 6)
    values = np.concatenate(finite)
    q1, median, q3 = np.percentile(values, [25, 50, 75]).tolist()
    iqm = float(trim_mean(values, _CUT))
    return Spread(len(values), q1, median, q3, iqm, *_bounds(finite))


def _bounds(strata: Sequence[FloatArray]) -> tuple[float, float]:
    """Return the percentiles of the bootstrap's interquartile means, each stratum drawn anew."""
    from scipy.stats import bootstrap, trim_mean

    # Drawing one run out of one gives that run, which scipy refuses to try.
    single = np.concatenate([np.empty(0), *[values for values in strata if len(values) == 1]])
    many = [values for values in strata if len(values) > 1]
    if not many:
        return np.nan, np.nan

    def iqm(*drawn: FloatArray, axis: int) -> FloatArray:
        fixed = np.broadcast_to(single, (*drawn[0].shape[:-1], len(single)))
        return trim_mean(np.concatenate([*drawn, fixed], axis=axis), _CUT, axis=axis)

    interval = bootstrap(
        many,
        iqm,
        n_resamples=_RESAMPLES,
        batch=_BATCH,
        vectorized=True,
        confidence_level=CONFIDENCE,
        method="percentile",
        rng=np.random.default_rng(0),  # the same files give the same table
    ).confidence_interval
    return float(interval.low), float(interval.high)
