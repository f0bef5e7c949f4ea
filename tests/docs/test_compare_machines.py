"""Two machines' runs are compared, and what cannot be compared is told."""

import json
import runpy
from pathlib import Path
from typing import Any

import pytest

COMPARE = runpy.run_path(
    str(Path(__file__).resolve().parents[2] / "scripts" / "compare_machines.py")
)["compare"]


def write_run(folder: Path, name: str, reached: float, **changes: Any) -> None:
    held = {
        "key": {"experiment": "fig6", "edition": 1},
        "row": {"success_rate": reached, "spl": float("nan"), "reactions": 7},
        "episodes": [{"reached": True, "duration": 3.0}],
        "curve": [],
        "machine": {"cpu_s": 2.5},
    }
    folder.mkdir(exist_ok=True)
    (folder / f"{name}.json").write_text(json.dumps(held | changes))


def test_runs_are_equal_near_or_apart(tmp_path: Path) -> None:
    here, there = tmp_path / "here", tmp_path / "there"
    for name, other in (("a", 0.5), ("b", 0.5 + 1e-12), ("c", 0.6)):
        write_run(here, name, 0.5)
        write_run(there, name, other)
    for name, changes in (("d", {"episodes": []}), ("e", {"row": {"success_rate": 0.5}})):
        write_run(here, name, 0.5)
        write_run(there, name, 0.5, **changes)
    write_run(here, "f", 0.5)  # that the other has not done
    assert COMPARE(here, there).splitlines() == [
        "1 runs the same to the bit, 1 to a share of 2e-12",
        "3 apart",
        "  c.json",
        "  d.json",
        "  e.json",
        "core seconds: 12 and 12",
    ]


def test_what_cannot_be_compared_is_told(tmp_path: Path) -> None:
    here, there = tmp_path / "here", tmp_path / "there"
    write_run(here, "a", 0.5)
    with pytest.raises(SystemExit, match="have no run in common"):
        COMPARE(here, there)
    write_run(there, "a", 0.5, key={"experiment": "fig6", "edition": 2})
    with pytest.raises(SystemExit, match=r"a\.json: of another version"):
        COMPARE(here, there)
