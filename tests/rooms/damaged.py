"""What damaged files are answered with: one line, soon, and nothing is written."""

import time
from collections.abc import Callable
from pathlib import Path

from hypothesis import HealthCheck, settings

from nomad_mj.errors import NomadError

many = settings(
    deadline=None, max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def told(work: Callable[[], object], folder: Path) -> str:
    """Return the line that work ends in, empty if it ends well; check that it writes nothing."""
    before = sorted(folder.rglob("*"))
    begin, said = time.perf_counter(), ""
    try:
        work()
    except NomadError as error:
        said = str(error)
    assert time.perf_counter() - begin < 10
    assert "\n" not in said and len(said) < 700
    assert sorted(folder.rglob("*")) == before
    return said
