"""`nomad-mj view`: its options, its mistakes, its end, and MuJoCo's window."""

import contextlib
import math
import signal
import socket
import subprocess
import sys
from typing import Any

import mujoco
import pytest
from known_view import Page
from nomad_agents.cli.main import main
from nomad_agents.cli.view import parse_start
from nomad_agents.viewer import Session, view_in_window
from nomad_agents.viewer.controls import LOOKING, Controls

import nomad_mj
from nomad_mj.errors import StartError


class Handle:
    """What the session needs of MuJoCo's viewer."""

    def __init__(self, model: mujoco.MjModel, taps: dict[int, int], on_key: Any) -> None:
        self.user_scn = mujoco.MjvScene(model, 2000)
        self.cam, self.opt = mujoco.MjvCamera(), mujoco.MjvOption()
        self.texts: list[Any] = []
        self.geoms: list[int] = []
        self.closed = False
        self._taps, self._on_key = taps, on_key

    def lock(self) -> Any:
        return contextlib.nullcontext()

    def set_texts(self, texts: list[Any]) -> None:
        self.texts = texts

    def sync(self) -> None:
        self.geoms.append(self.user_scn.ngeom)
        if len(self.geoms) in self._taps:
            self._on_key(self._taps[len(self.geoms)])

    def is_running(self) -> bool:
        return len(self.geoms) < 25

    def close(self) -> None:
        self.closed = True


def test_a_tap_in_the_window_drives_a_step() -> None:
    handles: list[Handle] = []
    with nomad_mj.load("path_finding", "empty_room") as env:
        session = Session(env, Controls(), start=(5.0, 5.0, 0.0))

        def launch(model: Any, data: Any, *, key_callback: Any, **options: bool) -> Handle:
            assert data is not env.physics.data.ptr and not any(options.values())
            handles.append(Handle(model, {2: 265, 4: 87}, key_callback))
            return handles[0]

        view_in_window(session, launch=launch)
        assert env.physics.pose().x > 5.1 and session.controls.take(LOOKING) == []
    (handle,) = handles
    assert handle.closed and min(handle.geoms) > 16  # the readings, at least
    assert "hand" in handle.texts[1][3]


def test_a_start_is_a_name_a_number_or_a_place_in_degrees() -> None:
    assert parse_start("") is None and parse_start("3") == 3 and parse_start("start_1") == "start_1"
    assert parse_start("1,2.5") == (1.0, 2.5)
    assert parse_start("1,2.5,90") == pytest.approx((1.0, 2.5, math.pi / 2))
    for wrong in ("1,x", "1,2,3,4", "nan,1", ","):
        with pytest.raises(StartError, match=r"must be X,Y or X,Y,HEADING"):
            parse_start(wrong)


@pytest.mark.gl
@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ("--room nowhere", "unknown room 'nowhere'; there are: "),
        ("--robot nobody", "unknown robot 'nobody'; there are: "),
        ("--agent nobody", "unknown agent 'nobody'; there are: "),
        ("--start 99", "start 99: the room's are numbered 0 to "),
        ("--start 1,2,3,4", "start '1,2,3,4': must be X,Y or X,Y,HEADING"),
        ("--port 99999", "port 99999: must be 1 to 65535, or 0 for any that is free"),
        ("--port PORT", "port PORT: Address already in use; --port 0 takes any"),
        ("--width 301", "picture 301 x 540: its width must be an even number"),
        ("--on wall", "view: invalid choice 'wall' for argument '--on'"),
        ("--seed -1", "seed -1: must be 0 or more"),
    ],
)
def test_a_mistake_is_told_in_one_line(
    arguments: str, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        given = [part.replace("PORT", port) for part in arguments.split()]
        on = [] if "--on" in given else ["--on", "browser"]
        assert main(["view", *on, *given]) == 2
    said = capsys.readouterr()
    assert said.err.startswith("nomad-mj: ") and said.err.count("\n") == 1
    assert told.replace("PORT", port) in said.err and said.out == ""


def test_a_window_needs_a_screen(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert main(["view", "--on", "window"]) == 2
    assert "there is no screen here" in capsys.readouterr().err


@pytest.mark.gl
def test_ctrl_c_ends_it_without_a_word() -> None:
    command = [sys.executable, "-W", "error", "-m", "nomad_agents.cli.main", "view"]
    with subprocess.Popen(
        [*command, "--on", "browser", "--port", "0", "--width", "320", "--height", "240"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # A shell lets what it runs in the background ignore Ctrl-C, and so would this.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as viewing:
        assert viewing.stdout is not None
        line = viewing.stdout.readline()
        try:
            with contextlib.closing(Page(line.split()[1])) as page:
                page.until(lambda state: state["time"] > 0.2)
        finally:
            viewing.send_signal(signal.SIGINT)
        out, err = viewing.communicate(timeout=20)
    assert (viewing.returncode, out, err) == (0, "", "")
    with pytest.raises(ConnectionRefusedError), contextlib.closing(socket.socket()) as gone:
        gone.connect(("127.0.0.1", int(page.connection.port)))
