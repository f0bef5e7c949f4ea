"""Damaged files of rooms: one clear line each, soon, and nothing is written."""

import functools
import math
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from nomad_agents.cli.main import main

from nomad_mj.errors import NomadError
from nomad_mj.movers import Movers
from nomad_mj.rooms import read_room
from nomad_mj.scene import build_scene

GOOD = """<mujoco model="r"><worldbody>
  <geom name="wall_south" type="box" pos="3 -0.1 0.45" size="3.2 0.1 0.45"/>
  <geom name="wall_north" type="box" pos="3 4.1 0.45" size="3.2 0.1 0.45"/>
  <geom name="wall_west" type="box" pos="-0.1 2 0.45" size="0.1 2 0.45"/>
  <geom name="wall_east" type="box" pos="6.1 2 0.45" size="0.1 2 0.45"/>
  <body name="moving_a" mocap="true" pos="3 1 0.45" user="0.5 1">
    <geom type="cylinder" size="0.2 0.45"/></body>
  <site name="goal" pos="5 3 0"/><site name="start_0" pos="1 1 0"/>
</worldbody></mujoco>"""
PGM = b"P5\n40 30\n255\n" + bytes(40 * 4) + bytes([0, 0, *[255] * 36, 0, 0]) * 22 + bytes(40 * 4)
many = settings(
    deadline=None, max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture]
)


def told(work: Callable[[], object], folder: Path) -> str:
    """Return the line that work ends in, empty if it ends well; check that it writes nothing."""
    before = sorted(folder.rglob("*"))
    begin, said = time.perf_counter(), ""
    try:
        work()
    except NomadError as error:
        said = str(error)
    assert time.perf_counter() - begin < 10
    assert "\n" not in said and len(said) < 700
    assert sorted(folder.rglob("*")) == before
    return said


def load(path: Path) -> None:
    scene = build_scene(path, "nomad200")
    if scene.moving:
        Movers(scene.moving, scene.plan, scene.arena.goal, scene.robot.layout.radius)


def inside(text: str) -> str:
    return GOOD.replace("<worldbody>", f"{text}<worldbody>")


MJCF: list[tuple[str | bytes, str]] = [
    ("", "empty file"),
    (b"\xff\xfe\x00\x01" * 50, "is not valid MJCF"),
    (GOOD.encode("utf-16"), "is not valid MJCF"),
    (GOOD.replace("wall_north", "w\xe4nd").encode("latin-1"), "not UTF-8 text"),
    (b"\0" * 9, "is not valid MJCF"),
    ("<html/>", "is not valid MJCF"),
    (GOOD[:300], "is not valid MJCF"),
    ("<mujoco/>", "has no site named 'goal'"),
    (GOOD.replace('"goal"', '"room/goal"'), "has no site named 'goal'"),
    (GOOD.replace("start_0", "begin"), "has no site whose name begins with 'start'"),
    (GOOD.replace("wall_north", "wall_south"), "repeated name"),
    (GOOD.replace("5 3 0", "a b c"), "bad format in attribute 'pos'"),
    (GOOD.replace("5 3 0", "5"), "does not have enough data"),
    (GOOD.replace("5 3 0", "nan 3 0"), "holds a NaN"),
    (GOOD.replace("5 3 0", "inf 3 0"), "site 'goal' is not within 100000 m"),
    (GOOD.replace("1 1 0", "1 -1e30 0"), "site 'start_0' is not within 100000 m"),
    (GOOD.replace('size="3.2', 'size="1e300'), "'wall_south' reaches farther than 100000 m"),
    (GOOD.replace('size="3.2', 'size="inf'), "'wall_south' reaches farther than 100000 m"),
    (GOOD.replace('pos="6.1', 'pos="1e20'), "'wall_east' reaches farther than 100000 m"),
    (GOOD.replace('size="3.2', 'size="-3'), "must be positive"),
    (GOOD.replace('size="3.2 0.1', 'size="nan 0.1'), "nan size"),
    (GOOD.replace("3 1 0.45", "-30 1 0.45"), "is outside the room"),
    (GOOD.replace('user="0.5', 'user="inf'), "a walker's must be its speed"),
    (GOOD.replace('mocap="true"', ""), "'moving_a' cannot move"),
    (inside('<include file="room.xml"/>'), "includes itself"),
    (inside('<include file="other.xml"/>'), "includes itself"),
    (inside('<include file="../../../../../../../../etc/passwd"/>'), "is not valid MJCF"),
    (inside('<include file="/etc/passwd"/>'), "is not valid MJCF"),
    (inside('<include file="none.xml"/>'), "is not valid MJCF"),
    (inside('<include file="."/>'), "which is no file"),
    (inside('<include file="/dev/zero"/>'), "which is no file"),
    (inside('<include file="pipe"/>'), "which is no file"),
    (inside('<asset><model name="m" file="room.xml"/></asset>'), "includes itself"),
    (inside('<size nuserdata="2000000000"/>'), "size of 2e+09 cells (nuserdata)"),
    (inside('<size nkey="2000000000"/>'), "size of 2e+09 cells (nkey)"),
    (inside('<size nuser_geom="2000000000"/>'), "size of 2e+09 cells (nuser_geom)"),
    (inside('<sensor><user dim="2000000000"/></sensor>'), "user of 2e+09 cells (dim)"),
    (
        GOOD.replace(
            "</worldbody>", '<flexcomp name="f" type="grid" count="60 60 1"/></worldbody>'
        ),
        "flexcomp of 3.6e+03 cells",
    ),
    (inside('<asset><mesh file="/etc/passwd"/></asset>'), "no decoder found"),
    (
        inside('<asset><hfield name="h" nrow="20000" ncol="20000" size="1 1 1 1"/></asset>'),
        "cells",
    ),
    (inside('<asset><texture builtin="flat" width="90000" height="90000"/></asset>'), "cells"),
    (inside('<extension><plugin plugin="none.none"/></extension>'), "is not valid MJCF"),
    (inside('<option timestep="nan"/>'), "holds a NaN"),
    (GOOD.replace("</worldbody>", "<body>" * 3000 + "</body>" * 3000 + "</worldbody>"), "too deep"),
    (
        GOOD.replace(
            "</worldbody>", '<replicate count="99999"><geom/><site/></replicate></worldbody>'
        ),
        "makes 2e+05 elements by replicate",
    ),
    (
        GOOD.replace(
            "</worldbody>",
            '<composite type="grid" count="999 999 1" spacing="1"><geom/></composite></worldbody>',
        ),
        "has a composite of 9.98e+05 cells (count); at most 5000",
    ),
]


@pytest.mark.parametrize("number", range(len(MJCF)))
def test_a_damaged_mjcf_file(number: int, tmp_path: Path) -> None:
    content, wanted = MJCF[number]
    path = tmp_path / "room.xml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    (tmp_path / "other.xml").write_text('<mujoco><include file="room.xml"/></mujoco>')
    os.mkfifo(tmp_path / "pipe")
    assert wanted in told(lambda: load(path), tmp_path)


def test_the_file_that_these_are_made_of_is_good(tmp_path: Path) -> None:
    (tmp_path / "room.xml").write_text(GOOD)
    assert not told(lambda: load(tmp_path / "room.xml"), tmp_path)


@settings(many, max_examples=30)
@given(data=st.data())
def test_bytes_that_have_changed(data: st.DataObject, tmp_path: Path) -> None:
    """Most is refused; what is left is a room."""
    text = bytearray(GOOD.encode())
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(text) - 1))
        kind = data.draw(st.sampled_from(["cut", "change", "twice"]))
        if kind == "cut":
            del text[at : at + data.draw(st.integers(1, 60))]
        elif kind == "change":
            text[at] = data.draw(st.integers(0, 255))
        else:
            text[at:at] = text[at : at + data.draw(st.integers(1, 60))]
    path = tmp_path / "room.xml"
    path.write_bytes(text)
    told(lambda: load(path), tmp_path)


NUMBERS = [None, True, -1, 0, 1e-9, 1e300, -math.inf, math.nan, 10**400]
TEXTS = ["", "a", "1e5", "\0", "~", ".", "../../../../../../etc/passwd", "/dev/zero", "/"]
LISTS = [[], [[]], [1], [1, 2, 3, 4, 5], [math.nan, 0, 0], ["a", "b"], [[0, 0], [0, 0], [0, 0]]]
ODD: st.SearchStrategy[Any] = st.sampled_from(
    [*NUMBERS, *TEXTS, *LISTS, {}, {1: 2}, [[0, 0], [1e6, 0], [0, 1e6]]]
)
MAP_KEYS = ["image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode"]
PLAN_KEYS = ["size", "outline", "height", "obstacles", "goal", "starts"]
SHAPES = st.dictionaries(st.sampled_from(["box", "cylinder", "polygon", "angle"]), ODD, max_size=2)


@many
@given(values=st.dictionaries(st.sampled_from(MAP_KEYS), ODD, min_size=1, max_size=3))
def test_odd_values_in_a_map(values: dict[str, Any], tmp_path: Path) -> None:
    (tmp_path / "map.pgm").write_bytes(PGM)
    held = {"image": "map.pgm", "resolution": 0.1, "origin": [0, 0, 0], **values}
    (tmp_path / "map.yaml").write_text(yaml.safe_dump(held))
    told(lambda: read_room(tmp_path / "map.yaml"), tmp_path)


@many
@given(
    values=st.dictionaries(st.sampled_from(PLAN_KEYS), ODD, max_size=3),
    shapes=st.lists(SHAPES, max_size=2),
)
def test_odd_values_in_a_plan(
    values: dict[str, Any], shapes: list[dict[str, Any]], tmp_path: Path
) -> None:
    held = {"size": [4, 4], "obstacles": shapes, **values}
    (tmp_path / "plan.yaml").write_text(yaml.safe_dump(held))
    told(lambda: read_room(tmp_path / "plan.yaml"), tmp_path)


YAML = [
    (b"", "must hold keys and values"),
    (b"\xff\x00" * 40, "is not valid YAML"),
    (b"a: [" * 5000, "is not valid YAML"),
    (
        b"a: &a [1,1,1,1,1,1,1,1,1]\nb: &b [*a,*a,*a,*a,*a,*a,*a,*a]\nsize: [*b,*b,*b,*b]",
        "*a stands for something else",
    ),
    (b"a: &a {b: 1}\n<<: *a", "*a stands for something else"),
    (b"size: " + b"[" * 900 + b"]" * 900, "more than 20 levels"),
    (b"size: [4, 4]\nstarts: [" + b"[1,1]," * 20000 + b"]", "50000 parts"),
    (b"size: [4, 4]\nstarts: [" + b"[1,1]," * 2000 + b"]", "2000 starts; at most 1000"),
    (b"size: [4, 4]\nobstacles: [" + b"1," * 3000 + b"]", "3000 obstacles; at most 2000"),
    (b"size: !!bool neither", "is not valid YAML"),
    (b"size: [4, 4]\ngoal: [40, 1]", "goal (40, 1) is outside; the room reaches"),
    (b"!!python/object/apply:os.system ['touch made']", "is not valid YAML"),
    (b"x: " + b"y" * 1_100_000, "is larger than 1 MB"),
    (b"- 1\n- 2", "must hold keys and values"),
    (b"size: [1e5, 1e5]", "larger than 1000 m"),
    (b"size: [99999999, 4]", "must be a number from"),
]


@pytest.mark.parametrize(("content", "wanted"), YAML)
def test_absurd_yaml(content: bytes, wanted: str, tmp_path: Path) -> None:
    (tmp_path / "plan.yaml").write_bytes(content)
    assert wanted in told(lambda: read_room(tmp_path / "plan.yaml"), tmp_path)


IMAGES = [
    (b"", "is no PGM"),
    (b"P5\n0 0\n255\n", "map.pgm"),
    (b"P5\n50000 50000\n255\n", "map.pgm"),
    (b"P5\n-4 4\n255\n", "map.pgm"),
    (b"P5\n40 30\n0\n" + bytes(1200), "map.pgm"),
    (b"P9\n4 4\n255\n" + bytes(16), "is no PGM"),
    (b"\x89PNG\r\n\x1a\n" + bytes(50), "is no PGM"),
    (b"BM" + b"\xff" * 60, "is no PGM"),
    (PGM[:500], "is no PGM"),
]


@pytest.mark.parametrize(("content", "wanted"), IMAGES)
def test_damaged_images(content: bytes, wanted: str, tmp_path: Path) -> None:
    (tmp_path / "map.pgm").write_bytes(content)
    for resolution in (0.1, 0.0, -1.0, math.nan, 1e9):
        path = tmp_path / "map.pgm"
        said = told(lambda path=path, r=resolution: read_room(path, resolution=r), tmp_path)
        assert said and (wanted in said or resolution != 0.1)


def test_a_map_that_is_noise_and_an_image_with_an_endless_name(tmp_path: Path) -> None:
    noise = np.where(np.random.default_rng(0).random((250, 250)) < 0.1, 0, 255).astype(np.uint8)
    (tmp_path / "map.pgm").write_bytes(b"P5\n250 250\n255\n" + noise.tobytes())
    for resolution in (0.05, 0.5):
        read = functools.partial(read_room, tmp_path / "map.pgm", resolution=resolution)
        assert "separate walls and things; at most 2000" in told(read, tmp_path)
    (tmp_path / "map.yaml").write_text(f"image: {'a' * 5000}\nresolution: 0.05")
    assert "does not exist" in told(lambda: read_room(tmp_path / "map.yaml"), tmp_path)
    assert "does not exist" in told(lambda: read_room(Path("a" * 5000)), tmp_path)


@many
@given(data=st.data())
def test_bytes_of_an_image_that_have_changed(data: st.DataObject, tmp_path: Path) -> None:
    content = bytearray(PGM)
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, 14))] = data.draw(st.integers(0, 255))
    (tmp_path / "map.pgm").write_bytes(content)
    told(lambda: read_room(tmp_path / "map.pgm", resolution=0.1), tmp_path)


@pytest.mark.parametrize("name", ["map.pgm", "plan.yaml", "folder.yaml", "none.yaml"])
def test_the_command_says_one_line_and_writes_nothing(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "map.pgm").write_bytes(PGM[:100])
    (tmp_path / "plan.yaml").write_text("size: [4, .nan]")
    (tmp_path / "folder.yaml").mkdir()
    before = sorted(tmp_path.iterdir())
    assert main(["room", name, *(["--resolution", "0.1"] if name == "map.pgm" else [])]) == 2
    said = capsys.readouterr()
    assert said.err.startswith("nomad-mj: ") and said.err.count("\n") == 1 and not said.out
    assert sorted(tmp_path.iterdir()) == before
