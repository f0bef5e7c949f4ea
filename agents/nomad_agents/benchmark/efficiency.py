"""Sample efficiency: how well an agent drives after so many decisions of learning, over seeds."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from nomad_agents.benchmark.checks import MASTERED
from nomad_agents.studies.runs import Result
from nomad_mj.types import FloatArray


class Efficiency(NamedTuple):
    """A curve of learning.

    Attributes
    ----------
    decisions : array (n,)
        Of learning.
    median, low, high : array (n,)
        Of the success rate over all runs, from where all have begun: median and quartiles.
    mastered : float
        Median over runs of the decisions until 90 %; inf if half of the runs never get there.
    """

    decisions: FloatArray
    median: FloatArray
    low: FloatArray
    high: FloatArray
    mastered: float


def sample_efficiency(results: Sequence[Result], kind: str = "") -> Efficiency | None:
    """Return the curve of some runs, None if none was checked while learning.

    A run that is over stays as it ended, so that the median is always that of all runs.

    Parameters
    ----------
    results : sequence of Result
        Of one agent.
    kind : str
        "" as it drives, "unaided_" without what taught it.
    """
    curves = [_curve(result, kind) for result in results]
    curves = [curve for curve in curves if len(curve)]
    if not curves:
        return None
    begun = max(curve[0, 0] for curve in curves)
    decisions = np.unique(np.concatenate([curve[:, 0] for curve in curves]))
    decisions = decisions[decisions >= begun]
    rates = np.array([np.interp(decisions, *curve.T) for curve in curves])  # (runs, n)
    low, median, high = np.percentile(rates, [25, 50, 75], axis=0)
    first = [curve[curve[:, 1] >= MASTERED, 0] for curve in curves]
    mastered = float(np.median([each[0] if len(each) else np.inf for each in first]))
    return Efficiency(decisions, median, low, high, mastered)


def _curve(result: Result, kind: str) -> FloatArray:
    """Return decisions and success rate (n, 2) of a run's checks."""
    key = f"{kind}success_rate"
    return np.array(
        [(entry["decisions"], entry[key]) for entry in result.curve if key in entry]
    ).reshape(-1, 2)
