"""Checkpoints are written whole or not at all, and found by name or path."""

from pathlib import Path
from typing import IO

import pytest
from nomad_agents.checkpoint import load_checkpoint, write_atomically
from nomad_agents.reactive_planner import TUNED
from nomad_agents.registry import find_agent

from nomad_mj.errors import CheckpointError, OutputError, UnknownNameError
from nomad_mj.types import RangeRing, SensorLayout

GOLDEN = Path(__file__).parent / "data" / "checkpoint_v1.npz"


def test_a_checkpoint_for_other_sensors_is_refused(layout: SensorLayout) -> None:
    ring = RangeRing("infrared", (0.0, 1.0), 0.2, 0.0, 1.5)
    with pytest.raises(CheckpointError, match=r"2 infrared to 1\.5 m, radius 0\.2 m$") as caught:
        find_agent(str(GOLDEN), SensorLayout(0.2, (ring,)), TUNED)
    assert "is for other sensors: 16 sonar to 6.5 m, 16 infrared to 0.6 m" in str(caught.value)
    own = load_checkpoint(GOLDEN).layout
    assert find_agent(str(GOLDEN), own, TUNED).name == "reactive_planner"


@pytest.mark.parametrize("name", ["nobody", "no/such/file", "a" * 300, "~nobody-there/x"])
def test_what_is_no_agent_and_no_file_lists_what_there_is(layout: SensorLayout, name: str) -> None:
    known = r"\.npz, dwa, planner, potential, ppo, .*, straight, td3, vfh$"
    with pytest.raises(UnknownNameError, match=known):
        find_agent(name, layout, TUNED)


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), ValueError("other")])
def test_a_write_that_fails_keeps_the_old_file_and_leaves_nothing(
    tmp_path: Path, error: Exception
) -> None:
    path = tmp_path / "c.npz"
    path.write_bytes(b"old")

    def write(file: IO[bytes]) -> None:
        file.write(b"half")
        raise error

    with pytest.raises(OutputError if isinstance(error, OSError) else ValueError) as caught:
        write_atomically(path, write)
    if isinstance(error, OSError):
        assert str(caught.value) == f"cannot write {str(path)!r}: No space left on device"
    assert path.read_bytes() == b"old" and list(tmp_path.iterdir()) == [path]


def test_a_place_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match=r"cannot write '.*file/c.npz': "):
        write_atomically(tmp_path / "file" / "c.npz", lambda file: file.write(b"x"))
    with pytest.raises(OutputError, match="directory"):
        write_atomically(tmp_path, lambda file: file.write(b"x"))
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
