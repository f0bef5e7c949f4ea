"""Performance profiles: what share of the runs scores above a threshold (Agarwal et al. 2021).

R. Agarwal, M. Schwarzer, P. S. Castro, A. Courville and M. G. Bellemare, "Deep reinforcement
learning at the edge of the statistical precipice", NeurIPS 2021, section 4.2: the empirical tail
distribution of scores over all runs of all tasks, with pointwise 95 % bands of a bootstrap that
draws within each task.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from nomad_mj.types import FloatArray

_RESAMPLES = 2_000
_BOUNDS = (2.5, 97.5)  # percent


class Profile(NamedTuple):
    """A performance profile, each (n,): thresholds, share of runs above, and its bounds."""

    thresholds: FloatArray
    share: FloatArray
    low: FloatArray
    high: FloatArray


def performance_profile(strata: Sequence[FloatArray], thresholds: npt.ArrayLike) -> Profile:
    """Return the share of runs whose score is above each threshold.

    Parameters
    ----------
    strata : sequence of arrays (runs,)
        Scores, an array for each task; NaN counts as a run that is above nothing.
    thresholds : array_like (n,)
        Where to look.

    Raises
    ------
    ValueError
        No run at all.
    """
    taus = np.asarray(thresholds, dtype=np.float64)
    above = [  # (runs, n)
        (values[:, None] > taus).astype(np.float64) for values in strata if len(values)
    ]
    runs = sum(len(each) for each in above)
    if not runs:
        raise ValueError("a performance profile needs a run at least")
    share = np.sum([each.sum(axis=0) for each in above], axis=0) / runs
    rng = np.random.default_rng(0)  # the same files give the same figure
    drawn = np.zeros((_RESAMPLES, len(taus)))
    for each in above:
        # How often each run is drawn, (resamples, runs).
        counts = rng.multinomial(len(each), np.full(len(each), 1 / len(each)), _RESAMPLES)
        drawn += counts @ each
    low, high = np.percentile(drawn / runs, _BOUNDS, axis=0)
    return Profile(taus, share, low, high)
