"""Environments of other simulators, and loops that run in them; for measure_peers.py."""

import json
import os
import subprocess
import sys
from collections.abc import Generator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

LOOP = Path(__file__).with_name("peer_loop.py")
_MARK = "installed.json"  # in an environment that is complete: what was installed
_MOST = 1800  # [s] that an installation may take


class Peer(NamedTuple):
    """A simulator to compare with: what it is, and what pip is told, run by run."""

    what: str
    installs: tuple[tuple[str, ...], ...]


PEERS = {
    "safety-gymnasium": Peer(
        "SafetyPointGoal1-v0, 16-bin lidars",
        (
            # It asks for a pygame, and through gymnasium-robotics for a numpy, that have no wheels
            # for Python 3.11 and later. Neither is used in a step.
            ("--no-deps", "safety-gymnasium==1.0.0", "gymnasium-robotics==1.2.2"),
            (
                *("gymnasium==0.28.1", "mujoco==2.3.3", "numpy==1.26.4", "pygame==2.6.1"),
                *("xmltodict==0.14.2", "pyyaml==6.0.2", "imageio==2.37.0", "jinja2==3.1.6"),
                "pettingzoo==1.24.3",
            ),
        ),
    ),
    "ir-sim": Peer(
        "differential robot, lidar of 100 beams, kinematics only",
        (("ir-sim==2.12.0", "numpy==2.4.6", "matplotlib==3.11.2", "shapely==2.2.0"),),
    ),
    "point-maze": Peer(
        "PointMaze_Large-v3, no range sensor",
        (("gymnasium-robotics==1.4.2", "gymnasium==1.4.0", "mujoco==4.0.0", "numpy==2.4.6"),),
    ),
}


class PeerError(Exception):
    """A peer cannot be measured, and why, in a line."""


class Block(NamedTuple):
    """What a simulator did in some time [s]."""

    steps: int
    simulated: float
    seconds: float


def reason(output: str) -> str:
    """Return the line of a failed program's output that tells most: its last error, or its last."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    told = [line for line in lines if "error" in line.lower() and "warning" not in line.lower()]
    return (told or lines or ["it ended without a word"])[-1][:200]


def install(peer: Peer, folder: Path) -> Path:
    """Return the interpreter of a peer's environment; make it unless it is there and complete."""
    python, mark = folder / "bin" / "python", folder / _MARK
    wanted = json.dumps(peer.installs)
    if mark.exists() and mark.read_text() == wanted and python.exists():
        return python
    pip = (str(python), "-m", "pip", "install", "--no-cache-dir", "--disable-pip-version-check")
    _call((sys.executable, "-m", "venv", "--clear", str(folder)))
    for packages in peer.installs:
        _call((*pip, *packages))
    mark.write_text(wanted)
    return python


def _call(command: Sequence[str]) -> None:
    """Run a program that says nothing unless it fails."""
    try:
        subprocess.run(
            command, check=True, timeout=_MOST, text=True, stdout=-1, stderr=subprocess.STDOUT
        )
    except subprocess.CalledProcessError as error:
        raise PeerError(reason(error.stdout)) from None
    except subprocess.TimeoutExpired:
        raise PeerError(f"not installed after {_MOST} s") from None
    except OSError as error:
        raise PeerError(f"{command[0]}: {error.strerror}") from None


class Loop:
    """A simulator that runs in a process of its own, and waits to be asked for a block."""

    def __init__(self, name: str, python: Path, folder: Path) -> None:
        self._errors = (folder / f"{name}.log").open("w+", encoding="utf-8")
        # One thread each; what libraries want to store goes to the temporary folder.
        own = {"OMP_NUM_THREADS": "1", "MPLCONFIGDIR": str(folder), "XDG_CACHE_HOME": str(folder)}
        self._process = subprocess.Popen(
            (str(python), str(LOOP), name),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            text=True,
            env={**os.environ, **own, "PYTHONDONTWRITEBYTECODE": "1"},
        )

    def answer(self, request: str = "") -> dict[str, Any]:
        """Return the next line that it writes."""
        assert self._process.stdin and self._process.stdout
        with suppress(BrokenPipeError):  # it has ended: the line that is missing says so
            self._process.stdin.write(request)
            self._process.stdin.flush()
        line = self._process.stdout.readline()
        if not line:
            self._process.wait()
            self._errors.seek(0)
            raise PeerError(reason(self._errors.read()))
        return json.loads(line)

    def block(self, seconds: float) -> Block:
        """Return what it does in so long."""
        return Block(**self.answer(f"{seconds}\n"))

    def close(self) -> None:
        """End it."""
        self._process.kill()
        self._process.communicate()
        self._errors.close()


@contextmanager
def running(name: str, python: Path, folder: Path) -> Generator[Loop, None, None]:
    """Give a loop that ends with the block."""
    loop = Loop(name, python, folder)
    try:
        yield loop
    finally:
        loop.close()
