"""Names and paths of rooms and robots."""

from collections.abc import Callable
from pathlib import Path

import pytest

from nomad_mj import assets
from nomad_mj.errors import ModelError, NomadError, UnknownNameError

ROOMS = (
    "clutter",
    "concave_room",
    "concave_room_deep",
    "corridor",
    "empty_room",
    "hall",
    "moving_room",
    "paper_room",
)
ROBOTS = ("khepera", "nomad200", "nomad200_wheels", "omnibot", "pioneer", "racer")
FIND: dict[str, Callable[[str | Path], Path]] = {
    "room": assets.find_room,
    "robot": assets.find_robot,
}
KNOWN = {"room": ROOMS, "robot": ROBOTS}


def test_all_that_come_with_the_package_are_found_by_name() -> None:
    assert tuple(assets.list_rooms()) == ROOMS
    assert tuple(assets.list_robots()) == ROBOTS
    for kind, names in KNOWN.items():
        for name in names:
            path = FIND[kind](name)
            assert path.is_file() and path.stem == name
    assert (assets.models_dir() / "scene.xml").is_file()


@pytest.mark.parametrize("kind", FIND)
def test_a_path_of_ones_own_is_taken_as_it_is(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = tmp_path / "own.xml"
    own.write_text("<mujoco/>")
    bare = tmp_path / "bare"
    bare.write_text("<mujoco/>")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    for given in (own, str(own), "own.xml", "./bare", bare, "~/own.xml"):
        assert FIND[kind](given).resolve() in (own, bare)


def test_a_name_wins_over_a_file_of_that_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "paper_room").write_text("<mujoco/>")
    monkeypatch.chdir(tmp_path)
    assert assets.find_room("paper_room") == assets.list_rooms()["paper_room"]


@pytest.mark.parametrize("kind", FIND)
@pytest.mark.parametrize("name", ["nowhere", "", "Paper_Room", "with space", "line\nbreak"])
def test_an_unknown_name_is_answered_with_all_there_are(kind: str, name: str) -> None:
    with pytest.raises(UnknownNameError) as caught:
        FIND[kind](name)
    assert str(caught.value) == f"unknown {kind} {name!r}; there are: {', '.join(KNOWN[kind])}"
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("kind", FIND)
@pytest.mark.parametrize(
    ("given", "what"),
    [
        ("missing.xml", "does not exist"),
        ("no/such/folder", "does not exist"),
        (Path("missing"), "does not exist"),
        ("line\nbreak.xml", "does not exist"),
        ("nul\0.xml", "does not exist"),
        ("/", "is a folder"),
        ("~nobody-of-that-name/x.xml", "cannot be looked up"),
        ("x" * 5000 + ".xml", "cannot be looked up"),
    ],
)
def test_a_path_without_a_file_is_answered_in_one_line(
    kind: str, given: str | Path, what: str
) -> None:
    with pytest.raises(ModelError) as caught:
        FIND[kind](given)
    message = str(caught.value)
    assert isinstance(caught.value, NomadError) and "\n" not in message and len(message) < 400
    assert message.startswith(f"{kind} file") and what in message
    assert message.endswith(", ".join(KNOWN[kind]))
