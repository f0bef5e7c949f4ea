"""Damaged MJCF files of rooms: one clear line each, soon, and nothing is written."""

import os
from pathlib import Path

import pytest
from damaged import many, told
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj.movers import Movers
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
