"""Work on Ray: on the processors of this machine, or on all machines of a cluster."""

import os
import shutil
import signal
import tempfile
from collections import Counter, deque
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any

from nomad_agents.studies.pool import TRIES, Done, Item, refuse_lost
from nomad_mj.errors import ConfigError, WorkerError

_STORE = 80 * 2**20  # bytes of shared memory, nearly Ray's least: results are small
_AHEAD = 2  # tasks a processor that wait on the cluster
_QUIET = {
    "RAY_USAGE_STATS_ENABLED": "0",
    "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0",
    "RAY_enable_metrics_collection": "0",
    "RAY_BACKEND_LOG_LEVEL": "fatal",
}


def has_ray() -> bool:
    """Return whether Ray is installed."""
    return find_spec("ray") is not None


@contextmanager
def _connected(jobs: int, address: str) -> Generator[Any, None, None]:
    """Yield ray, started on this machine or connected to a cluster; leave as it was found."""
    for name, value in _QUIET.items():
        os.environ.setdefault(name, value)
    import ray  # an extra; and it takes a second

    quiet: dict[str, Any] = {"log_to_driver": False, "logging_level": "critical"}
    # Of a socket in this folder the path must be short.
    folder = "" if address else tempfile.mkdtemp(prefix="nomad-mj-", dir="/tmp")
    before = signal.getsignal(signal.SIGTERM)
    try:
        if address:
            ray.init(address=address, **quiet)
        else:
            ray.init(
                address="local",
                num_cpus=jobs,
                num_gpus=0,
                object_store_memory=_STORE,
                include_dashboard=False,
                _temp_dir=folder,
                **quiet,
            )
        signal.signal(signal.SIGTERM, before)  # Ray's ends the process without a word
        yield ray
    finally:
        ray.shutdown()
        signal.signal(signal.SIGTERM, before)
        shutil.rmtree(folder, ignore_errors=True) if folder else None


def sweep_run(work: Callable[[Item], Done], item: Item) -> Done:
    """Do a task; Ray's tools and the list of processes show it by this name."""
    return work(item)


def do_on_ray(
    work: Callable[[Item], Done], items: Sequence[Item], jobs: int, address: str
) -> Generator[tuple[Item, Done], None, None]:
    """Yield each item with what came of it, as they come.

    Ray does a task again whose worker was killed or whose machine has gone; what it gives up is
    handed in again.

    Parameters
    ----------
    work : callable
        Of a module that is installed on every machine.
    items : sequence
        What to call it with, each unlike the others.
    jobs : int
        Processors of this machine to use; a cluster has its own.
    address : str
        Of a running cluster, ``auto`` or ``HOST:PORT``; none if empty.

    Raises
    ------
    ConfigError
        No cluster at that address.
    WorkerError
        Items that were given up `TRIES` times, after all others are done.
    Exception
        What `work` raised, at once.
    """
    with _reached(jobs, address) as ray:
        task = ray.remote(num_cpus=1, max_retries=1)(sweep_run)
        todo, killed, waiting = deque(items), Counter[Item](), dict[Any, Item]()
        while todo or waiting:
            most = _AHEAD * max(int(ray.cluster_resources().get("CPU", 1)), 1)
            while todo and len(waiting) < most:
                item = todo.popleft()
                waiting[task.remote(work, item)] = item
            for ready in ray.wait(list(waiting), timeout=1.0)[0]:
                item = waiting.pop(ready)
                try:
                    done = ray.get(ready)
                except ray.exceptions.RayTaskError as error:
                    raise error.cause from None
                except ray.exceptions.RayError:
                    killed[item] += 1
                    if killed[item] < TRIES:
                        todo.append(item)
                    continue
                yield item, done
    refuse_lost(killed)


@contextmanager
def _reached(jobs: int, address: str) -> Generator[Any, None, None]:
    """Yield ray; say in one line why it cannot be reached or started."""
    begun = False
    try:
        with _connected(jobs, address) as ray:
            begun = True
            yield ray
    except (ConnectionError, TimeoutError, ValueError, RuntimeError, OSError) as error:
        if begun:
            raise
        reason = " ".join(str(error).split())[:200]
        if address:
            raise ConfigError(
                f"no Ray cluster at --address {address}: {reason}; one that asks for a token needs "
                "RAY_AUTH_MODE=token here too"
            ) from None
        raise WorkerError(
            f"Ray does not start here: {reason}; --backend processes does without"
        ) from None
