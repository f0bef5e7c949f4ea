"""Damaged maps and plans of rooms: one clear line each, soon, and nothing is written."""

import functools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from damaged import many, told
from hypothesis import given
from hypothesis import strategies as st
from nomad_agents.cli.main import main

from nomad_mj.rooms import read_room

PGM = b"P5\n40 30\n255\n" + bytes(40 * 4) + bytes([0, 0, *[255] * 36, 0, 0]) * 22 + bytes(40 * 4)
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
