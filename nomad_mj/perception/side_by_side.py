"""Work on many robots, some hundreds at a time, on several threads."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

AT_ONCE = 256
"""Robots that are worked on together: what that takes stays in the processor's cache."""


def side_by_side(work: Callable[[slice], None], count: int, threads: int) -> None:
    """Call `work` for slices of `AT_ONCE` that make up `count`, on so many threads."""
    slices = [slice(first, first + AT_ONCE) for first in range(0, count, AT_ONCE)]
    if threads > 1 and len(slices) > 1:
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(work, slices))  # NumPy lets threads run side by side
    else:
        for part in slices:
            work(part)
