"""Where results come from."""

from collections.abc import Sequence

from nomad_agents.studies.runs import Result


def all_of(results: Sequence[Result], key: str) -> str:
    """Return every value that the machines of the results have under a name."""
    return "; ".join(sorted({str(r.machine[key]) for r in results if key in r.machine})) or "-"
