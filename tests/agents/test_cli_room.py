"""``nomad-mj room``: what it writes, and every mistake in one line."""

import json
from pathlib import Path

import numpy as np
import pytest
from nomad_agents.cli.main import main
from PIL import Image

import nomad_mj


def image(path: Path) -> str:
    pixels = np.zeros((60, 80), dtype=np.uint8)
    pixels[2:-2, 2:-2] = 255
    Image.fromarray(pixels).save(path)
    return str(path)


def test_rooms_are_written_and_load(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "room.xml")
    for source in (["random", "--seed", "3"], [image(tmp_path / "a.png"), "--resolution", "0.1"]):
        assert main(["room", *source, "-o", out, "--starts", "4", "--json"]) == 0
        said = json.loads(capsys.readouterr().out)
        assert said["room"] == out and said["starts"] == 4
        with nomad_mj.load("motor", room=out) as env:
            assert np.allclose(env.task.scene.arena.goal, said["goal"])


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["none.yaml"], "room file 'none.yaml' does not exist"),
        (["random", "--out", "room.txt"], "this writes .xml"),
        (["random", "--seed", "-1"], "seed -1: must be 0 or more"),
        (["random", "--resolution", "0.1"], "takes no --resolution"),
        (["a.png", "--resolution", "0.1", "--seed", "0"], "--seed: only for a room that is made"),
        (["plan.yaml", "--difficulty", "0.5"], "--difficulty: only for a room that is made up"),
        (["plan.yaml", "--within", "3"], "within 3: a part is taken of a map, and this is a plan"),
        (["maze", "--difficulty", "2"], "difficulty 2: must be 0 to 1"),
        (["maze", "--goal", "here"], "goal 'here': must be X,Y in metres"),
        (["maze", "--goal", "nan,1"], "goal"),
        (["random", "--starts", "0"], "starts 0: must be 1 to 1000"),
        (["a.png"], "an image needs a resolution"),
        (["a.png", "--resolution", "0.1", "--within", "-1"], "within -1: must be above 0 m"),
        (["a.png", "--resolution", "nan"], "resolution nan: must be 0.0001 to 100"),
        (["a.png", "--resolution", "0.001"], "does not fit at"),
        (["paper.xml"], "its name must end in one of .yaml, .yml, .pgm, .png, .bmp"),
    ],
)
def test_mistakes_are_told_in_one_line(
    arguments: list[str],
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    image(tmp_path / "a.png")
    (tmp_path / "paper.xml").write_text("<mujoco/>")
    (tmp_path / "plan.yaml").write_text("size: [6, 4]\n")
    assert main(["room", *arguments]) == 2
    said = capsys.readouterr().err
    assert told in said and said.count("\n") == 1
    assert not (tmp_path / "room.xml").exists()
