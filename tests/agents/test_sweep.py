"""``nomad-mj sweep`` as its users call it: killed in parts or as a whole, the same table."""

import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from nomad_agents.cli.main import main
from nomad_agents.sweeps.ray_pool import has_ray

GRID = ("agent=straight,planner", "range_noise=0.05,0.3", "--seeds", "2", "--starts", "1")
COUNT = 8
PROCESSES, RAY = "processes", "ray"


def table(out: Path) -> str:
    """Return all that must be the same, as text: a NaN is unlike itself."""
    held: pa.Table = pq.read_table(out / "sweep.parquet")
    same = [name for name in held.column_names if not name.startswith("machine_")]
    return f"{held.select(same).schema.remove_metadata()}\n{held.select(same).to_pylist()}"


def done(out: Path) -> int:
    journal = out / "sweep.journal"
    return journal.read_bytes().count(b"\n") if journal.exists() else 0


@pytest.fixture(scope="module")
def words(small_room: Path) -> list[str]:
    return [f"room={small_room}", *GRID]


@pytest.fixture(scope="module")
def whole(words: list[str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a sweep that nothing disturbed."""
    out = tmp_path_factory.mktemp("whole")
    assert main(["sweep", *words, "--out", str(out), "--jobs", "1", "--backend", PROCESSES]) == 0
    return out


def start(words: list[str], out: Path, backend: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "nomad_agents.cli.main", "sweep", *words, "--out", str(out)]
    return subprocess.Popen(
        [*command, "--jobs", "1", "--backend", backend],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        # A shell lets what it runs in the background ignore Ctrl-C, and so would this.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def until(so: Callable[[], bool], process: subprocess.Popen[str]) -> None:
    began = time.monotonic()
    while not so():
        assert time.monotonic() - began < 120 and process.poll() is None
        time.sleep(0.01)


def workers(process: subprocess.Popen[str]) -> list[int]:
    """Return the processes below one that do its runs."""
    parents: dict[int, int] = {}
    titles: dict[int, str] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            stat = (folder / "stat").read_text()
            titles[int(folder.name)] = (folder / "cmdline").read_text()
        except OSError:
            continue
        parents[int(folder.name)] = int(stat.rpartition(")")[2].split()[1])

    def is_below(pid: int) -> bool:
        while pid > 1 and pid != process.pid:
            pid = parents.get(pid, 0)
        return pid == process.pid

    doing = re.compile(r"spawn_main|ray::sweep_run")
    return [pid for pid, title in titles.items() if doing.search(title) and is_below(pid)]


def kill_worker(process: subprocess.Popen[str]) -> None:
    until(lambda: bool(workers(process)), process)
    os.kill(workers(process)[0], signal.SIGKILL)


def test_it_tells_what_it_has_found(
    whole: Path, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    held = pq.read_table(whole / "sweep.parquet")
    assert held.num_rows == COUNT and {"room", "range_noise", "seed"} <= set(held.column_names)
    assert all(seconds > 0 for seconds in held["machine_wall_s"].to_pylist())
    assert len((whole / "sweep.md").read_text().splitlines()) == 2 + 2 + 4
    names = {path.name for path in whole.glob("sweep_*")}
    assert names == {f"sweep_{m}.{s}" for m in ("success_rate", "spl") for s in ("pdf", "png")}
    before = (whole / "sweep.parquet").read_bytes(), (whole / "sweep_spl.png").read_bytes()
    for more in (["--only-read"], [*words, "--jobs", "1", "--backend", PROCESSES]):
        assert main(["sweep", *more, "--json", "--out", str(whole)]) == 0
        told = json.loads(capsys.readouterr().out)
        assert told["runs"] == told["of"] == COUNT and len(told["cells"]) == 4
    again = (whole / "sweep.parquet").read_bytes(), (whole / "sweep_spl.png").read_bytes()
    assert again == before
    assert main(["sweep", "--only-read", "--metric", "joy", "--out", str(whole)]) == 2
    assert "unknown metric 'joy'; there are: episodes, success_rate" in capsys.readouterr().err


@pytest.mark.parametrize("backend", [PROCESSES, RAY])
def test_with_workers_killed_twice_it_is_the_same(
    words: list[str], whole: Path, tmp_path: Path, backend: str
) -> None:
    if backend == RAY and not has_ray():
        pytest.skip("Ray is not installed")
    process = start(words, tmp_path, backend)
    kill_worker(process)
    until(lambda: done(tmp_path) >= 2, process)
    kill_worker(process)
    assert process.wait(timeout=180) == 0, process.communicate()[1]
    process.communicate()
    assert table(tmp_path) == table(whole)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_killed_as_a_whole_it_goes_on_to_the_same(
    words: list[str], whole: Path, tmp_path: Path, number: int
) -> None:
    process = start(words, tmp_path, PROCESSES)
    until(lambda: done(tmp_path) >= 2, process)
    process.send_signal(number)
    process.communicate(timeout=60)
    assert process.returncode in (130, -number)
    assert main(["sweep", "--only-read", "--out", str(tmp_path)]) == 0
    for _ in range(2):
        words = [*words, "--out", str(tmp_path), "--backend", PROCESSES]
        assert main(["sweep", *words]) == 0
        assert table(tmp_path) == table(whole)


def test_a_full_disk_is_told_and_nothing_is_lost(words: list[str], tmp_path: Path) -> None:
    command = [sys.executable, "-m", "nomad_agents.cli.main", "sweep", *words]
    ran = subprocess.run(
        [*command, "--out", str(tmp_path), "--jobs", "1", "--backend", PROCESSES],
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000)),
    )
    assert ran.returncode == 2 and "Traceback" not in ran.stderr
    assert re.search(r"nomad-mj: cannot write '.*sweep.*': File too large\n$", ran.stderr)
    assert main(["sweep", "--only-read", "--out", str(tmp_path)]) == 0
