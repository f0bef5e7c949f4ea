"""Timings of other simulators: what the numbers come to, and what is told of a peer that fails."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
sys.path.append(str(SCRIPTS))

from measure_peers import as_json, compare, markdown, update  # noqa: E402 # pyright: ignore[reportMissingImports]
from peer_environments import Block, Peer, PeerError, install, reason, running  # noqa: E402 # pyright: ignore[reportMissingImports]

from nomad_mj.errors import ConfigError  # noqa: E402

VERSIONS = ({"python": "3.11.7", "ir-sim": "2.12.0"}, {"nomad-mj": "0.1.0"})
# The machine is half as fast for the second pair: each pair's ratio is 4, 4 and 5.
PAIRS = [
    (Block(100, 10.0, 1.0), Block(800, 40.0, 1.0)),
    (Block(50, 5.0, 1.0), Block(400, 20.0, 1.0)),
    (Block(200, 20.0, 2.0), Block(2000, 100.0, 2.0)),
]


def test_rates_are_medians_and_the_ratio_is_that_of_pairs() -> None:
    found = compare(PAIRS, VERSIONS)
    assert (found.peer.simulated, found.peer.steps) == (10.0, 100.0)
    assert (found.ours.simulated, found.ours.steps) == (40.0, 800.0)
    assert found.ratio == 4.0


def test_a_page_gets_the_table_and_the_reason_of_a_peer_that_failed() -> None:
    results = {"ir-sim": compare(PAIRS, VERSIONS), "point-maze": PeerError("no wheel")}
    page = update("before\n<!-- peers -->\nold\n<!-- end -->\nafter\n", markdown(results))
    assert page.startswith("before\n<!-- peers -->\n") and page.endswith("<!-- end -->\nafter\n")
    assert "old" not in page and "| ir-sim 2.12.0 | 100 | 10 | 40 | 4 |" in page
    assert "not measured: no wheel" in page and "nomad-mj 0.1.0" in page
    assert update(page, markdown(results)) == page
    with pytest.raises(ConfigError, match="<!-- peers -->"):
        update("nothing here", "")
    told = json.loads(json.dumps(as_json(results)))
    assert told["point-maze"] == {"error": "no wheel"} and told["ir-sim"]["ratio"] == 4.0


@pytest.mark.parametrize(
    ("output", "told"),
    [
        ("Collecting x\nERROR: No matching distribution\nWARNING: error in a cache\n", "ERROR: No"),
        ("Traceback\n  raise\nValueError: mutable default", "ValueError: mutable"),
        ("Killed\n", "Killed"),
        ("", "it ended without a word"),
    ],
)
def test_the_reason_is_the_last_error(output: str, told: str) -> None:
    assert reason(output).startswith(told)


def test_ours_is_timed_by_its_own_clock(tmp_path: Path) -> None:
    with running("nomad_mj", Path(sys.executable), tmp_path) as loop:
        assert loop.answer()["python"] == sys.version.split()[0]
        for _ in range(2):
            block = loop.block(0.05)
            assert block.seconds >= 0.05 and block.steps >= 1
            assert block.simulated == pytest.approx(block.steps * 0.05)


def test_a_loop_that_fails_says_why(tmp_path: Path) -> None:
    with (
        running("no-such-simulator", Path(sys.executable), tmp_path) as loop,
        pytest.raises(PeerError, match="KeyError: 'no-such-simulator'"),
    ):
        loop.answer()


def test_an_environment_that_cannot_be_made_says_why(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("a file where a folder should be")
    with pytest.raises(PeerError, match=r".+"):
        install(Peer("what", ()), tmp_path / "taken")


def test_bad_input_is_told_in_a_line_before_anything_is_installed(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("no place")
    for options in (["--doc", str(page)], ["--blocks", "0"]):
        command = [sys.executable, str(SCRIPTS / "measure_peers.py"), *options]
        ran = subprocess.run(command, capture_output=True, text=True, check=False)
        assert ran.returncode == 2 and len(ran.stderr.splitlines()) == 1, ran.stderr
