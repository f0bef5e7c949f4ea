"""Work in parallel processes, in which a process that is killed costs no more than what it did."""

import multiprocessing
import os
import signal
import threading
from collections import Counter, deque
from collections.abc import Callable, Generator, Hashable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Generic, TypeVar

from typing_extensions import Self

from nomad_mj.errors import WorkerError

TRIES = 3  # what has killed so many processes would kill the next
Item = TypeVar("Item", bound=Hashable)
Done = TypeVar("Done")


def _obey() -> None:
    """Leave Ctrl-C to the process that holds the pool; go when it goes, even if it was killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_follow_parent, daemon=True).start()


def _follow_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)  # files are written whole or not at all: nothing is lost but this run


class _Crew(Generic[Item, Done]):
    """Pools of one process each: if one breaks, it is known at what, and the others go on.

    Left with an exception, Ctrl-C included, it ends its processes at once.
    """

    def __init__(self, work: Callable[[Item], Done], size: int) -> None:
        self._work = work
        self._idle = [_one_process() for _ in range(size)]
        self._busy: dict[Future[Done], tuple[ProcessPoolExecutor, Item]] = {}

    @property
    def busy(self) -> bool:
        """Whether anything is under way."""
        return bool(self._busy)

    def take_from(self, todo: deque[Item]) -> None:
        """Let idle processes begin what is to be done, as far as they go round."""
        while todo and self._idle:
            pool, item = self._idle.pop(), todo.popleft()
            self._busy[pool.submit(self._work, item)] = pool, item

    def finished(self) -> Generator[tuple[Item, Future[Done]], None, None]:
        """Wait until an item is over; yield those that are, a new process for each killed one."""
        for future in wait(self._busy, return_when=FIRST_COMPLETED).done:
            pool, item = self._busy.pop(future)
            if isinstance(future.exception(), BrokenProcessPool):
                pool.shutdown()
                pool = _one_process()
            self._idle.append(pool)
            yield item, future

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None:
            for process in multiprocessing.active_children():
                process.terminate()  # nobody who interrupts wants to wait for the present runs
        for pool in [*self._idle, *(pool for pool, _ in self._busy.values())]:
            pool.shutdown(cancel_futures=True)


def _one_process() -> ProcessPoolExecutor:
    # Spawned, not forked: a process starts without what this one has done so far.
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(1, mp_context=context, initializer=_obey)


def do_in_processes(
    work: Callable[[Item], Done], items: Sequence[Item], jobs: int
) -> Generator[tuple[Item, Done], None, None]:
    """Yield each item with what came of it, as they come; whatever ends this ends the processes.

    An item whose process was killed is done again by another.

    Parameters
    ----------
    work : callable
        Called in a process of its own; a function of a module, or a `functools.partial` of one.
    items : sequence
        What to call it with, each unlike the others.
    jobs : int
        Number of processes.

    Raises
    ------
    WorkerError
        Items whose process was killed `TRIES` times, after all others are done.
    Exception
        What `work` raised, at once.
    """
    todo = deque(items)
    killed: Counter[Item] = Counter()
    with _Crew(work, min(jobs, len(items))) as crew:
        while todo or crew.busy:
            crew.take_from(todo)
            for item, future in crew.finished():
                try:
                    done = future.result()
                except BrokenProcessPool:
                    killed[item] += 1
                    if killed[item] < TRIES:
                        todo.append(item)
                    continue
                yield item, done
    refuse_lost(killed)


def refuse_lost(killed: Counter[Item]) -> None:
    """Raise WorkerError if an item has killed as many processes as are tried."""
    if lost := sum(count >= TRIES for count in killed.values()):
        raise WorkerError(
            f"{lost} of the runs killed their process {TRIES} times, perhaps for want of memory; "
            "what is done is kept: take fewer --jobs and run again"
        )
