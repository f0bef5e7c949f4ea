"""Runs in processes: done once, kept, the same however often they were interrupted."""

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Generator, Sequence
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from known_work import die_at_two, draw, draw_slowly, fail_at_two, runs
from nomad_agents.studies import runs as module
from nomad_agents.studies.digest import digest
from nomad_agents.studies.runs import Result, Run, do_runs, stored_result

from nomad_mj.errors import ConfigError, OutputError, WorkerError

COUNT = 4
CODE = """
import sys
from pathlib import Path
from known_work import draw_slowly, runs
from nomad_agents.studies.runs import do_runs
if __name__ == "__main__":
    do_runs(runs(40), draw_slowly, Path(sys.argv[1]), 2, lambda result: print(1, flush=True))
"""


def done(folder: Path) -> list[int]:
    path = folder / "done.txt"
    return sorted(map(int, path.read_text().split())) if path.exists() else []


def numbers(results: list[Result]) -> str:
    """Return what must be the same, as text: a NaN is unlike itself."""
    return repr([(r.run, r.row, r.episodes, r.curve, r.pictures) for r in results])


def test_results_come_in_the_order_of_the_runs_whatever_the_number_of_processes(
    tmp_path: Path,
) -> None:
    told: list[Result] = []
    for jobs in (1, 3):
        folder = tmp_path / str(jobs)
        folder.mkdir()
        results = do_runs(runs(COUNT), draw, folder, jobs, told.append)
        assert [result.run for result in results] == runs(COUNT)
        assert numbers(results) == numbers([draw(run, tmp_path) for run in runs(COUNT)])
    assert len(told) == 2 * COUNT
    for name in ("wall_s", "cpu_s"):
        assert all(result.machine[name] >= 0 for result in told)


def test_what_is_on_file_is_not_done_again(tmp_path: Path) -> None:
    first = do_runs(runs(2), draw, tmp_path, 1, lambda _: None)
    again = do_runs(runs(COUNT), draw, tmp_path, 2, lambda _: None)
    assert done(tmp_path) == list(range(COUNT))
    assert numbers(again[:2]) == numbers(first)
    # Nothing is left to do, not even what would fail.
    held = do_runs(runs(COUNT), fail_at_two, tmp_path, 1, lambda _: None)
    assert numbers(held) == numbers(again)
    assert done(tmp_path) == list(range(COUNT))


def test_another_version_or_configuration_is_done_again(tmp_path: Path) -> None:
    run = runs(1)[0]
    do_runs([run], draw, tmp_path, 1, lambda _: None)
    path = tmp_path / run.file_name
    for part, value in (("packages", {"mujoco": "0.1"}), ("parameters", {"k_z": 7})):
        held = json.loads(path.read_text())
        held["key"][part] = value
        path.write_text(json.dumps(held))
        assert stored_result(run, tmp_path) is None
        do_runs([run], draw, tmp_path, 1, lambda _: None)
        assert stored_result(run, tmp_path) is not None


def test_results_can_be_read_where_a_package_is_missing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = runs(1)[0]
    do_runs([run], draw, tmp_path, 1, lambda _: None)

    def missing(name: str) -> str:
        if name == "mujoco":
            raise PackageNotFoundError(name)
        return version(name)

    monkeypatch.setattr(module, "version", missing)
    assert stored_result(run, tmp_path) is not None


@given(content=st.binary(max_size=60) | st.sampled_from([b"{}", b'{"key": 1}', b"[]", b"null"]))
def test_a_damaged_file_is_told_by_name(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    folder = tmp_path_factory.mktemp("damaged")
    run = runs(1)[0]
    (folder / run.file_name).write_bytes(content)
    try:
        assert stored_result(run, folder) is None
    except OutputError as error:
        assert run.file_name in str(error) and "\n" not in str(error)


def test_an_error_in_a_run_comes_through_and_keeps_the_others(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"^two: must be anything else$"):
        do_runs(runs(COUNT), fail_at_two, tmp_path, 1, lambda _: None)
    assert [run.seed for run in runs(COUNT) if stored_result(run, tmp_path)][:2] == [0, 1]


def test_what_is_raised_between_two_results_ends_the_processes(tmp_path: Path) -> None:
    def interrupt(_: Result) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as raised:
        do_runs(runs(40), draw_slowly, tmp_path, 2, interrupt)
    assert raised.traceback  # still held, as a caller may
    left = done(tmp_path)
    time.sleep(0.7)
    assert done(tmp_path) == left and len(left) < 40


def test_a_process_that_is_killed_is_told_and_the_others_are_kept(tmp_path: Path) -> None:
    with pytest.raises(WorkerError, match="1 of the runs killed their process 3 times"):
        do_runs(runs(COUNT), die_at_two, tmp_path, 1, lambda _: None)
    assert stored_result(runs(1)[0], tmp_path) is not None
    assert len(do_runs(runs(COUNT), draw, tmp_path, 1, lambda _: None)) == COUNT


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_killed_at_any_moment_it_goes_on_to_the_same_numbers(tmp_path: Path, number: int) -> None:
    code = tmp_path / "code.py"
    code.write_text(CODE)
    process = subprocess.Popen(
        [sys.executable, str(code), str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={"PYTHONPATH": ":".join(sys.path), "PATH": ""},
        # A shell lets what it runs in the background ignore Ctrl-C, and so would this.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    assert process.stdout is not None
    process.stdout.readline()
    process.send_signal(number)
    began = time.monotonic()
    process.communicate(timeout=20)  # until nobody holds its output: no orphan either
    assert time.monotonic() - began < 10
    left = done(tmp_path)
    assert 1 <= len(left) < 40
    time.sleep(0.7)
    assert done(tmp_path) == left, "an orphan goes on"
    results = do_runs(runs(40), draw, tmp_path, 2, lambda _: None)
    assert numbers(results) == numbers([draw(run, tmp_path) for run in runs(40)])


def test_a_result_is_that_of_a_room_wherever_it_lies_but_not_of_an_edited_one(
    tmp_path: Path, small_room: Path
) -> None:
    content = small_room.read_text()
    one, other = (
        replace(runs(1)[0], room=str(tmp_path / folder / "room.xml")) for folder in ("a", "b")
    )
    for run in (one, other):
        Path(run.room).parent.mkdir()
        Path(run.room).write_text(content)
    do_runs([one], draw, tmp_path, 1, lambda _: None)
    assert one.file_name == other.file_name
    assert stored_result(one, tmp_path) is not None
    assert stored_result(other, tmp_path) is not None
    Path(one.room).write_text(content.replace("</mujoco>", "<!-- edited --></mujoco>"))
    assert stored_result(one, tmp_path) is None


def test_a_digest_is_of_all_files_that_a_model_is_made_of(tmp_path: Path) -> None:
    folder = tmp_path / "meshes"
    folder.mkdir()
    (tmp_path / "part.xml").write_text('<mujoco><include file="deeper.xml"/></mujoco>')
    (tmp_path / "deeper.xml").write_text("<mujoco/>")
    (folder / "box.stl").write_bytes(b"\0\1")
    model = tmp_path / "model.xml"
    model.write_text(
        "<mujoco><compiler meshdir=\"meshes\"/><include file = 'part.xml'/>"
        '<asset><mesh file="box.stl"/><mesh file="nowhere.stl"/></asset></mujoco>'
    )
    told = [digest(model)]
    for path in (tmp_path / "deeper.xml", folder / "box.stl", model):
        path.write_bytes(path.read_bytes() + b" ")
        told.append(digest(model))
    assert len(set(told)) == 4


def in_this_process(
    work: Callable[[Run], Result], runs: Sequence[Run], jobs: int
) -> Generator[tuple[Run, Result], None, None]:
    for run in runs:
        yield run, work(run)


def test_a_room_edited_while_a_run_is_under_way_is_not_the_runs(
    tmp_path: Path, small_room: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    room = tmp_path / "room.xml"
    room.write_text(small_room.read_text())
    run = replace(runs(1)[0], room=str(room))

    monkeypatch.setattr(module, "do_in_processes", in_this_process)

    def work(run: Run, folder: Path) -> Result:
        room.write_text(room.read_text() + " ")
        return draw(run, folder)

    do_runs([run], work, tmp_path, 1, lambda _: None)
    assert stored_result(run, tmp_path) is None


def test_a_digest_of_a_robot_is_of_its_data_sheet_too(ring_robot: Callable[[], Path]) -> None:
    path = ring_robot()
    run = replace(runs(1)[0], robot=str(path))
    told = [module._key(run)]  # pyright: ignore[reportPrivateUsage]
    for text in ("base: base", "base: base\nnumbers: {radius: 0.3}"):
        path.with_suffix(".yaml").write_text(text)
        told.append(module._key(run))  # pyright: ignore[reportPrivateUsage]
    path.with_suffix(".yaml").unlink()
    assert told[0] == module._key(run)  # pyright: ignore[reportPrivateUsage]
    assert len({str(each["files"]) for each in told}) == 3
