"""``nomad-mj sweep`` as its users call it: killed in parts or as a whole, the same table."""

import json
import os
import re
import resource
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from nomad_agents.cli import sweep as command
from nomad_agents.cli.main import main
from nomad_agents.sweeps.ray_pool import has_ray
from nomad_agents.sweeps.store import read_store

# One that learns and one that does not, each soon done.
GRID = (
    *("agent=straight,reactive_planner", "range_noise=0.3", "robot=omnibot"),
    *("max_passes=1", "episode_decisions=3", "test_decisions=1", "evaluate.max_decisions=2"),
    *("--seeds", "3", "--starts", "1"),
)
COUNT = 6
PROCESSES, RAY = "processes", "ray"
HERE = ("--jobs", "1", "--backend", PROCESSES)
needs_ray = pytest.mark.skipif(not has_ray(), reason="Ray is not installed: nomad-mj[sweep]")


def table(out: Path) -> str:
    """Return all that must be the same, as text: a NaN is unlike itself."""
    held: pa.Table = pq.read_table(out / "sweep.parquet")
    same = [name for name in held.column_names if not name.startswith("machine_")]
    return f"{held.select(same).schema.remove_metadata()}\n{held.select(same).to_pylist()}"


def done(out: Path) -> int:
    store = read_store(out)
    return 0 if store is None else len(store.rows)


@pytest.fixture(scope="module")
def words(small_room: Path) -> list[str]:
    return [f"room={small_room}", *GRID]


@pytest.fixture(scope="module")
def whole(words: list[str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a sweep that nothing disturbed, made where there is no Ray."""
    out = tmp_path_factory.mktemp("whole")
    with pytest.MonkeyPatch.context() as patched:
        patched.setitem(sys.modules, "ray", None)
        assert main(["sweep", *words, "--out", str(out), "--jobs", "1"]) == 0
    return out


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw no figures: it takes longer than the runs."""

    def none(*_: object) -> tuple[list[Path], int]:
        return [], 0

    monkeypatch.setattr(command, "draw", none)


PROGRAM = """
from nomad_agents.cli import main, sweep
sweep.draw = lambda *_: ([], 0)
raise SystemExit(main.main())
"""


def start(words: list[str], out: Path, *how: str) -> subprocess.Popen[str]:
    program = [sys.executable, "-c", PROGRAM, "sweep", *words, "--out", str(out)]
    return subprocess.Popen(
        [*program, *([] if "--address" in how else ["--jobs", "1"]), *how],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        # A shell lets what it runs in the background ignore Ctrl-C, and so would this.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def until(so: Callable[[], bool], process: subprocess.Popen[str], pause: float = 0.02) -> None:
    began = time.monotonic()
    while not so():
        assert time.monotonic() - began < 120 and process.poll() is None
        time.sleep(pause)


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
    until(lambda: bool(workers(process)), process, pause=0.2)  # to look takes long
    os.kill(workers(process)[0], signal.SIGKILL)


def test_it_tells_what_it_has_found(
    whole: Path, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    held = pq.read_table(whole / "sweep.parquet")
    assert held.num_rows == COUNT and {"room", "range_noise", "seed"} <= set(held.column_names)
    assert all(seconds > 0 for seconds in held["machine_wall_s"].to_pylist())
    for agent, learnt in zip(
        held["agent"].to_pylist(), held["learn_decisions"].to_pylist(), strict=True
    ):
        assert learnt is None if agent == "straight" else 3 <= learnt <= 3 * 3
    assert (whole / "sweep.md").read_text().count("\n") == 2 + 2 + 2
    shown = ("success_rate", "spl", "learn_reactions")
    names = {path.name for path in whole.glob("sweep_*")}
    assert names == {f"sweep_{metric}.{suffix}" for metric in shown for suffix in ("pdf", "png")}
    before = (whole / "sweep.parquet").read_bytes(), (whole / "sweep_spl.png").read_bytes()
    for more in (["--only-read"], [*words, *HERE]):
        assert main(["sweep", *more, "--metric", "spl", "--json", "--out", str(whole)]) == 0
        told = json.loads(capsys.readouterr().out)
        assert told["runs"] == told["of"] == COUNT and len(told["cells"]) == 2
    again = (whole / "sweep.parquet").read_bytes(), (whole / "sweep_spl.png").read_bytes()
    assert again == before
    assert main(["sweep", "--only-read", "--metric", "joy", "--out", str(whole)]) == 2
    assert "unknown metric 'joy'; there are: episodes, success_rate" in capsys.readouterr().err


@needs_ray
def test_with_workers_of_ray_killed_twice_it_is_the_same(
    words: list[str], whole: Path, tmp_path: Path
) -> None:
    process = start(words, tmp_path, "--backend", RAY)
    kill_worker(process)
    until(lambda: done(tmp_path) >= 1, process)
    kill_worker(process)
    assert process.wait(timeout=180) == 0, process.communicate()[1]
    process.communicate()
    assert table(tmp_path) == table(whole)


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


@contextmanager
def ray_head() -> Generator[str, None, None]:
    """Yield the address of a cluster of one processor; end it, and nothing else of Ray."""
    address, folder = f"127.0.0.1:{free_port()}", tempfile.mkdtemp(prefix="head-", dir="/tmp")
    options = {
        "port": address.partition(":")[2],
        "ray-client-server-port": free_port(),
        "num-cpus": 1,
        "num-gpus": 0,
        "object-store-memory": 80 * 2**20,
        "include-dashboard": "false",
        "temp-dir": folder,  # the path of a socket in it must be short
    }
    head = subprocess.Popen(
        [
            *(sys.executable, "-m", "ray.scripts.scripts", "start", "--head", "--block"),
            *(f"--{name}={value}" for name, value in options.items()),
            "--disable-usage-stats",
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        assert head.stdout is not None
        said: list[str] = []
        for line in head.stdout:
            said.append(line)
            if "Ray runtime started" in line:
                break
        else:
            pytest.fail("".join(said))
        yield address
    finally:
        head.terminate()  # and with it, thanks to --block, all that it started
        head.communicate(timeout=60)
        shutil.rmtree(folder, ignore_errors=True)


@needs_ray
def test_on_a_cluster_it_is_the_same(
    words: list[str], whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RAY_AUTH_MODE", "token")
    monkeypatch.setenv("RAY_AUTH_TOKEN", secrets.token_hex(32))
    for patience in ("raylet_start_wait_time_s", "agent_register_timeout_ms"):
        monkeypatch.setenv(f"RAY_{patience}", "300" if patience.endswith("_s") else "300000")
    with ray_head() as address:
        process = start(words, tmp_path, "--address", address)
        said = process.communicate(timeout=180)[1]
    assert process.returncode == 0, said
    assert table(tmp_path) == table(whole)


def test_without_ray_it_is_asked_for_in_one_line(
    words: list[str],
    whole: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    for how in (["--backend", RAY], ["--address", "auto"]):
        assert main(["sweep", *words, *how, "--out", str(tmp_path)]) == 2
        said = capsys.readouterr().err
        assert said.endswith("need Ray: pip install 'nomad-mj[sweep]'\n")
        assert said.count("\n") == 1 and not list(tmp_path.iterdir())
    assert pq.read_table(whole / "sweep.parquet").num_rows == COUNT  # by processes


@pytest.mark.usefixtures("undrawn")
def test_killed_in_parts_and_as_a_whole_it_goes_on_to_the_same(
    words: list[str], whole: Path, tmp_path: Path
) -> None:
    held = 0
    for number, kills in ((signal.SIGKILL, 2), (signal.SIGINT, 0)):
        process = start(words, tmp_path, "--backend", PROCESSES)
        for more in range(kills):
            kill_worker(process)
            until(lambda least=more + 1: done(tmp_path) >= least, process)
        until(lambda before=held: done(tmp_path) > before, process)
        process.send_signal(number)
        process.communicate(timeout=60)
        assert process.returncode in (130, -number)
        assert main(["sweep", "--only-read", "--out", str(tmp_path)]) == 0
        held = done(tmp_path)
        assert 2 <= held < COUNT
    for _ in range(2):
        assert main(["sweep", *words, "--out", str(tmp_path), *HERE]) == 0
        assert table(tmp_path) == table(whole)


@pytest.mark.usefixtures("undrawn")
def test_a_full_disk_is_told_and_nothing_is_lost(
    words: list[str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # Python would keep compiled modules that were cut off.
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4000, limits[1]))
    try:
        code = main(["sweep", *words, "--out", str(tmp_path), *HERE])
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    said = capsys.readouterr().err
    assert code == 2
    assert re.search(r"nomad-mj: cannot write '.*sweep.*': File too large\n$", said)
    assert main(["sweep", "--only-read", "--out", str(tmp_path)]) == 0
