"""Tell how far two machines agree on the runs that both have done.

    python scripts/compare_machines.py renders/reproduce/faithful/runs other/reproduce/faithful/runs

Reads the result files of `nomad-mj reproduce` or `nomad-mj benchmark` of the same name. Runs whose
numbers are times (experiment `timing`) are left out.
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

_TINY = 1e-3  # below which a difference is not a share of the number but of this
_SAME = 1e-8  # that rounding makes, as long as no decision comes out otherwise


def leaves(held: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Yield every value within lists and dicts with its place; of a list its length, too."""
    if isinstance(held, dict):
        for key, value in held.items():
            yield from leaves(value, f"{name}/{key}")
    elif isinstance(held, list):
        yield f"{name}#", len(held)
        for number, value in enumerate(held):
            yield from leaves(value, f"{name}/{number}")
    else:
        yield name, held


def difference(one: Any, other: Any) -> float:
    """Return how much two values differ, as a share; infinite if they cannot be compared."""
    if one == other or (one != one and other != other):  # or both NaN
        return 0.0
    if isinstance(one, float) and isinstance(other, float):
        return abs(one - other) / max(abs(one), abs(other), _TINY)
    return float("inf")


def numbers(held: dict[str, Any]) -> dict[str, Any]:
    """Return all numbers of a run but those of its machine."""
    return dict(leaves([held["row"], held["episodes"], held["curve"]]))


def compare(here: Path, there: Path) -> str:
    """Return how many runs agree, how far, and the work of either machine."""
    equal, near, apart, seconds = 0, list[float](), list[str](), [0.0, 0.0]
    for path in sorted(here.glob("*.json")):
        if not (there / path.name).exists():
            continue
        pair = [json.loads((folder / path.name).read_text()) for folder in (here, there)]
        keys = [held["key"] for held in pair]
        if keys[0]["experiment"] == "timing":
            continue
        if keys[0] != keys[1]:
            sys.exit(f"{path.name}: of another version, other parameters, another room or robot")
        seconds = [s + held["machine"]["cpu_s"] for s, held in zip(seconds, pair, strict=True)]
        one, other = map(numbers, pair)
        off = max((difference(one[k], other.get(k, "")) for k in one), default=0.0)
        if one.keys() != other.keys() or off > _SAME:
            apart.append(path.name)
        elif off:
            near.append(off)
        else:
            equal += 1
    if not (equal or near or apart):
        sys.exit(f"{here} and {there} have no run in common")
    lines = [
        f"{equal} runs the same to the bit, {len(near)} to a share of {max(near, default=0):.0e}",
        "\n  ".join([f"{len(apart)} apart", *apart]),
        f"core seconds: {seconds[0]:.0f} and {seconds[1]:.0f}",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    print(compare(*map(Path, sys.argv[1:])))
