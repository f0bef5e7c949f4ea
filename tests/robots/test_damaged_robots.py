"""Damaged robot files bring one clear line each: no traceback, no hang, no file written."""

import re
import time
from pathlib import Path

import numpy as np
import pytest

from nomad_mj.assets import list_robots
from nomad_mj.errors import NomadError
from nomad_mj.scene import build_scene

SLOW = 10.0  # [s]
VALUES = (
    "",
    "nan",
    "inf",
    "-1e300",
    "1e300",
    "0",
    "-1",
    "a b c",
    "1 2 3 4 5 6 7 8 9",
    "\u00e9",
    "-",
)
ATTRIBUTE = re.compile(r'(\w+)="([^"]*)"')
ELEMENT = re.compile(r"<(\w+)[^<>]*/>")
EACH = 20


def whole(robot: str) -> str:
    """Return a robot's MJCF with its parts written in place."""
    path = list_robots()[robot]
    text = path.read_text()

    def part(match: re.Match[str]) -> str:
        inner = (path.parent / match[1]).read_text()
        return re.sub(r"</?mujocoinclude[^>]*>", "", inner)

    return re.sub(r'<include file="([^"]+)"\s*/>', part, text)


def damage(text: str, rng: np.random.Generator) -> bytes:
    """Return a file with something wrong: a value, an element, a bite, a flipped byte."""
    kind = int(rng.integers(6))
    if kind in (0, 1):
        found = list(ATTRIBUTE.finditer(text))
        hit = found[int(rng.integers(len(found)))]
        value = VALUES[int(rng.integers(len(VALUES)))]
        return (text[: hit.start(2)] + value + text[hit.end(2) :]).encode()
    if kind == 2:
        found = list(ELEMENT.finditer(text))
        hit = found[int(rng.integers(len(found)))]
        return (text[: hit.start()] + text[hit.end() :]).encode()
    if kind == 3:
        found = list(ATTRIBUTE.finditer(text))
        hit = found[int(rng.integers(len(found)))]
        return (text[: hit.start(1)] + "x" + text[hit.start(1) :]).encode()
    raw = bytearray(text.encode())
    if kind == 4:
        return bytes(raw[: int(rng.integers(len(raw)))])
    for _ in range(20):
        raw[int(rng.integers(len(raw)))] = int(rng.integers(256))
    return bytes(raw)


def loads_or_tells(folder: Path, file: Path) -> bool:
    """Return whether a file loads; it must do so in time, or bring one line that names it."""
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    began = time.monotonic()
    try:
        build_scene("empty_room", file)
        told = ""
    except NomadError as error:
        told = str(error)
        assert told and "\n" not in told and len(told) < 1000, told
        assert file.stem in told, told
    assert time.monotonic() - began < SLOW
    assert {p: p.read_bytes() for p in folder.rglob("*") if p.is_file()} == before
    return not told


@pytest.fixture(autouse=True)
def in_its_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("robot", ["nomad200", "pioneer", "omnibot", "racer"])
def test_damaged_mjcf(robot: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    text, file = whole(robot), tmp_path / "damaged.xml"
    rng = np.random.default_rng(sum(map(ord, robot)))
    loaded = 0
    for _ in range(EACH):
        file.write_bytes(damage(text, rng))
        loaded += loads_or_tells(tmp_path, file)
    assert loaded < EACH  # most damage tells
    assert capfd.readouterr() == ("", "")


FILES = {
    "empty": b"",
    "blank": b"   \n",
    "binary": bytes(range(256)) * 40,
    "no robot": b"<mujoco/>",
    "not mujoco": b"<html><body/></html>",
    "text": b"drive: differential\n",
    "includes itself": b'<mujoco><include file="damaged.xml"/></mujoco>',
    "includes nothing": b'<mujoco><include file="nowhere.xml"/></mujoco>',
    "path traversal": b'<mujoco><include file="../../../../../../etc/passwd"/></mujoco>',
    "a folder": b'<mujoco><include file="."/></mujoco>',
    "mesh of nowhere": b'<mujoco><asset><mesh file="no.stl"/></asset></mujoco>',
    "entities": b'<!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]><mujoco model="&x;"/>',
    "deep": b"<mujoco><worldbody>" + b'<body><geom size="1"/>' * 3000,
    "texture": (
        b"<mujoco><asset><texture builtin='flat' width='999999' height='999999'/></asset></mujoco>"
    ),
    "replicas": (
        b"<mujoco><worldbody><replicate count='999999999' offset='1 0 0'><body/></replicate>"
        b"</worldbody></mujoco>"
    ),
}


@pytest.mark.parametrize("content", FILES.values(), ids=FILES.keys())
def test_files_that_are_no_robots(content: bytes, tmp_path: Path) -> None:
    file = tmp_path / "damaged.xml"
    file.write_bytes(content)
    assert not loads_or_tells(tmp_path, file)


SHEET = """drive: omni
base: base
motors: [wheel_0, wheel_1, wheel_2]
numbers: {radius: 0.2, wheel_radius: 0.05, lidar_min_range: 0.05}
rings:
  near: {count: 8, height: 0.2, distance: 0.19, half_angle: 20, rays: 3, range: [0.0, 1.5]}
"""


def test_damaged_data_sheets(tmp_path: Path) -> None:
    file = tmp_path / "damaged.xml"
    file.write_text(whole("omnibot"))
    rng = np.random.default_rng(7)
    values = (
        "nan",
        "-1",
        "1e300",
        "[]",
        "{}",
        "null",
        "'x'",
        "*a",
        "&a [*a]",
        ".inf",
        "!!python/none",
    )
    (tmp_path / "damaged.yaml").write_text(SHEET)
    assert loads_or_tells(tmp_path, file)
    for trial in range(20):
        words = re.split(r"([:,\[\]{} \n]+)", SHEET)
        place = 2 * int(rng.integers(len(words) // 2))
        words[place] = values[trial % len(values)] if trial % 3 else ""
        (tmp_path / "damaged.yaml").write_text("".join(words))
        loads_or_tells(tmp_path, file)


@pytest.mark.parametrize("content", [b"\xff\xfe\x00", b"- 1\n- 2", b"a: &a [*a]", b"[" * 900])
def test_files_that_are_no_data_sheets(content: bytes, tmp_path: Path) -> None:
    file = tmp_path / "damaged.xml"
    file.write_text(whole("omnibot"))
    (tmp_path / "damaged.yaml").write_bytes(content)
    assert not loads_or_tells(tmp_path, file)
