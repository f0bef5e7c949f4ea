"""Checkpoints: round trip, every kind of damage in one line, whole or not at all."""

import io
import json
import pickle
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import cattrs
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from nomad_agents.checkpoint import load_checkpoint, save_checkpoint
from nomad_agents.reactive_planner import TUNED, ReactivePlanner

from nomad_mj.errors import CheckpointError
from nomad_mj.types import SensorLayout

GOLDEN = Path(__file__).parent / "data" / "checkpoint_v1.npz"
GOOD = GOLDEN.read_bytes()
Metadata = dict[str, Any]


def arrays_of(path: Path = GOLDEN) -> dict[str, Any]:
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def metadata() -> Metadata:
    return json.loads(str(arrays_of()["metadata"]))


def written(path: Path, **changed: Any) -> Path:
    """Write the golden checkpoint with other arrays; None leaves one out."""
    arrays = {**arrays_of(), **changed}
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})
    return path


def refusal(path: Path) -> str:
    """Return the one line that says what is wrong with a checkpoint."""
    with pytest.raises(CheckpointError) as caught:
        load_checkpoint(path)
    told = str(caught.value)
    assert "\n" not in told and repr(str(path)) in told and len(told) < len(str(path)) + 400
    assert caught.value.__suppress_context__ or not caught.value.__context__
    return told


def test_what_is_saved_is_loaded(tmp_path: Path, layout: SensorLayout) -> None:
    agent = ReactivePlanner(layout, TUNED)
    rng = np.random.default_rng(0)
    for number in range(200):
        agent.network.add_category(rng.random(2), -rng.random())
        agent.network.add_exemplar(rng.random(26), number)
    agent.network.weights[:] = rng.random((200, 2))
    agent.plannings = 210
    state = {"plannings": 210, "seed": 3, "sim_s": 0.1 + 0.2}
    save_checkpoint(tmp_path / "a.npz", agent, "a room", "a robot", state)
    loaded = load_checkpoint(tmp_path / "a.npz")
    assert (loaded.layout, loaded.room, loaded.robot) == (layout, "a room", "a robot")
    assert loaded.agent.config == TUNED and loaded.agent.plannings == 210
    assert loaded.training == state
    ours, theirs = agent.network.arrays(), loaded.agent.network.arrays()
    assert all(np.array_equal(ours[name], theirs[name]) for name in ours)
    assert [path.name for path in tmp_path.iterdir()] == ["a.npz"]


def test_an_agent_that_knows_nothing_is_saved_too(tmp_path: Path, layout: SensorLayout) -> None:
    agent = ReactivePlanner(layout, TUNED)
    save_checkpoint(tmp_path / "a.npz", agent, "", "", {"plannings": 0})
    assert len(load_checkpoint(tmp_path / "a.npz").agent.network.category) == 0


def test_missing_files_and_folders(tmp_path: Path) -> None:
    assert "does not exist" in refusal(tmp_path / "no.npz")
    assert "cannot be read" in refusal(tmp_path)


def test_a_truncated_checkpoint_is_corrupt(tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    for size in {0, 1, 4, 30, 100, len(GOOD) // 2, len(GOOD) - 1, *range(0, len(GOOD), 997)}:
        path.write_bytes(GOOD[:size])
        assert "corrupt" in refusal(path)


@settings(max_examples=300)
@given(st.lists(st.tuples(st.integers(0, len(GOOD) - 1), st.integers(1, 255)), min_size=1))
@example([(8, 99)])  # a method of compression that there is not
@example([(6, 1)])  # encrypted, it says
def test_flipped_bytes_are_refused_or_do_no_harm(
    tmp_path_factory: pytest.TempPathFactory, flips: list[tuple[int, int]]
) -> None:
    path = tmp_path_factory.getbasetemp() / "flipped.npz"
    damaged = bytearray(GOOD)
    for place, flip in flips:
        damaged[place] ^= flip
    path.write_bytes(damaged)
    try:
        agent = load_checkpoint(path).agent
    except CheckpointError as error:
        assert "\n" not in str(error)
    else:  # what the zip does not check: times, attributes
        whole = arrays_of()
        for name, array in agent.network.arrays().items():
            assert np.array_equal(array, whole[name]), name


@given(st.binary(max_size=300))
def test_any_bytes_are_no_checkpoint(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    path = tmp_path_factory.getbasetemp() / "any.npz"
    for start in (b"", b"PK\x03\x04", b"\x93NUMPY\x01\x00"):
        path.write_bytes(start + content)
        refusal(path)


def npy(array: Any) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def test_other_files_are_no_checkpoints(tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    for content in (npy(np.zeros(3)), pickle.dumps({"metadata": 1}), b"x,y\n", b"{}"):
        path.write_bytes(content)
        assert "corrupt or no checkpoint" in refusal(path)
    np.savez(path, some=np.zeros(3))
    refusal(path)
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("readme.txt", "no arrays")
    refusal(path)


class Exploit:
    def __reduce__(self) -> tuple[Callable[[str], object], tuple[str]]:
        return (pytest.fail, ("a pickle was loaded",))


@pytest.mark.parametrize("name", ["value", "metadata"])
def test_pickles_are_never_loaded(tmp_path: Path, name: str) -> None:
    trap = np.empty(1, dtype=object)
    trap[0] = Exploit()
    assert "corrupt" in refusal(written(tmp_path / "c.npz", **{name: trap}))


@pytest.mark.parametrize("name", [name for name in arrays_of() if name != "metadata"])
def test_every_array_must_be_there_and_make_sense(tmp_path: Path, name: str) -> None:
    path, array = tmp_path / "c.npz", arrays_of()[name]
    wrong = [None, array[:-1], array[None], array.astype(np.float32), array.astype("U8"), array[0]]
    if array.dtype.kind == "f":
        wrong += [np.full_like(array, np.nan), np.full_like(array, np.inf)]
    for other in wrong:
        assert "corrupt" in refusal(written(path, **{name: other}))


@pytest.mark.parametrize(
    ("key", "value", "told"),
    [
        ("format", "something else", "no checkpoint of 'nomad_mj.checkpoint'"),
        ("format", None, "no checkpoint of"),
        ("version", 2, "is of version 2; this program reads version 1"),
        ("version", None, "is of version None; this program reads version 1"),
        ("version", "1", "this program reads version 1"),
        ("config", None, "corrupt"),
        ("config", [], "corrupt"),
        ("config", {}, "corrupt"),
        ("layout", {"radius": 0.2}, "corrupt"),
        ("layout", 7, "corrupt"),
        ("training", None, "corrupt"),
        ("training", {}, "corrupt"),
        ("training", {"plannings": "many"}, "corrupt"),
        ("training", {"plannings": float("inf")}, "corrupt"),
        ("room", ..., "corrupt"),
        ("robot", ..., "corrupt"),
    ],
)
def test_metadata_must_be_whole(tmp_path: Path, key: str, value: Any, told: str) -> None:
    changed = {**metadata(), key: value}
    if value is ...:
        del changed[key]
    path = written(tmp_path / "c.npz", metadata=np.array(json.dumps(changed)))
    assert told in refusal(path)


@pytest.mark.parametrize(
    "text", ["", "{", "null", "[1]", '"text"', "\x00", "[" * 20_000, '{"format": NaN}']
)
def test_metadata_must_be_a_json_object(tmp_path: Path, text: str) -> None:
    refusal(written(tmp_path / "c.npz", metadata=np.array(text)))


def ways(data: Metadata, way: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Return the ways to every value in nested data."""
    found: list[tuple[str, ...]] = []
    for key, inner in data.items():
        found.append((*way, key))
        if isinstance(inner, dict):
            found += ways(cast(Metadata, inner), (*way, key))
    return found


odd = st.sampled_from([None, "x", [], {}, -1, 0, 10**12, 1e300, float("nan"), float("inf"), True])


@settings(max_examples=150)
@given(st.sampled_from([w for w in ways(metadata()) if w[0] in ("config", "layout")]), odd)
def test_odd_parameters_are_refused_in_one_line_or_are_what_was_saved(
    tmp_path_factory: pytest.TempPathFactory, way: tuple[Any, ...], value: Any
) -> None:
    changed = metadata()
    inner: Any = changed
    for key in way[:-1]:
        inner = inner[key]
    inner[way[-1]] = value
    path = written(
        tmp_path_factory.getbasetemp() / "odd.npz", metadata=np.array(json.dumps(changed))
    )
    try:
        loaded = load_checkpoint(path)
    except CheckpointError as error:
        assert "\n" not in str(error)
    else:
        for kind, made in (("config", loaded.agent.config), ("layout", loaded.layout)):
            assert json.loads(json.dumps(cattrs.unstructure(made))) == changed[kind]


@pytest.mark.parametrize("way", [("config",), ("config", "planner"), ("config", "situation")])
def test_parameters_that_lack_or_are_unknown_are_refused(
    tmp_path: Path, way: tuple[str, ...]
) -> None:
    for change in ("add", "remove"):
        changed = metadata()
        inner: Any = changed
        for key in way:
            inner = inner[key]
        if change == "add":
            inner["k_unknown"] = 1.0
        else:
            inner.pop(next(iter(inner)))
        path = written(tmp_path / "c.npz", metadata=np.array(json.dumps(changed)))
        assert "corrupt" in refusal(path)
