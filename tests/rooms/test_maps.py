"""Maps become rooms that stand where the map says, and damaged ones are told in one line."""

import math
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import yaml
from PIL import Image

import nomad_mj
from nomad_mj.errors import NomadError
from nomad_mj.rooms import FREE, OCCUPIED, UNKNOWN, Occupancy, read_room, read_ros_map, to_mjcf
from nomad_mj.rooms.occupancy import room_of_map

RESOLUTION = 0.05


def floor(rows: int = 120, columns: int = 160) -> np.ndarray:
    """Return pixels of a closed room of 8 x 6 m with a table, and a room behind its wall."""
    pixels = np.full((rows, columns), 205, dtype=np.uint8)
    pixels[5:-5, 5:-5] = 0
    pixels[8:-8, 8:110] = 254
    pixels[8:-8, 114:-8] = 254
    pixels[50:70, 40:52] = 0
    return pixels


def write_map(folder: Path, pixels: np.ndarray, image: str = "map.pgm", **values: Any) -> Path:
    Image.fromarray(pixels).save(folder / image)
    held = {"image": image, "resolution": RESOLUTION, "origin": [-1.0, 2.0, 0.0], **values}
    held = {"negate": 0, "occupied_thresh": 0.65, "free_thresh": 0.196, **held}
    path = folder / "map.yaml"
    path.write_text(yaml.safe_dump(held))
    return path


def write_plain_pgm(path: Path, pixels: np.ndarray) -> None:
    rows = "\n".join(" ".join(str(int(value)) for value in row) for row in pixels)
    path.write_text(f"P2\n# a comment\n{pixels.shape[1]} {pixels.shape[0]}\n255\n{rows}\n")


def test_all_kinds_of_images_say_the_same(tmp_path: Path) -> None:
    pixels = floor()
    usual = read_ros_map(write_map(tmp_path, pixels)).cells
    assert {*np.unique(usual)} == {FREE, OCCUPIED, UNKNOWN}
    assert (usual[::-1] == np.select([pixels == 254, pixels == 0], [FREE, OCCUPIED], UNKNOWN)).all()
    assert (read_ros_map(write_map(tmp_path, pixels, "map.png")).cells == usual).all()
    colours = np.repeat(pixels[..., None], 3, axis=-1)
    assert (read_ros_map(write_map(tmp_path, colours, "map.png")).cells == usual).all()
    negative = write_map(tmp_path, 255 - pixels, negate=1)
    assert (read_ros_map(negative).cells == usual).all()
    plain = write_map(tmp_path, pixels)
    write_plain_pgm(tmp_path / "map.pgm", pixels)
    assert (read_ros_map(plain).cells == usual).all()


@pytest.mark.parametrize(
    ("key", "meant"),
    [
        ("orgin", "origin"),
        ("Negate", "negate"),
        ("occupied_threshold", "occupied_thresh"),
        ("free_threshold", "free_thresh"),
    ],
)
def test_a_misspelt_key_is_told(key: str, meant: str, tmp_path: Path) -> None:
    path = write_map(tmp_path, floor())
    path.write_text(path.read_text().replace(meant, key))
    with pytest.raises(NomadError, match=f"knows no '{key}'; is it '{meant}'"):
        read_ros_map(path)


def test_keys_of_other_programs_are_ignored(tmp_path: Path) -> None:
    path = write_map(
        tmp_path, floor(), original="a.pgm", model="x", negative=1, orgin_x=1, Origin=3
    )
    assert (read_ros_map(path).cells == read_ros_map(write_map(tmp_path, floor())).cells).all()


def test_what_is_transparent_is_unknown(tmp_path: Path) -> None:
    pixels = floor()
    path = write_map(tmp_path, pixels, "map.png")
    usual = read_ros_map(path).cells
    opacity = np.where(pixels == 254, 0, 255).astype(np.uint8)
    Image.fromarray(np.dstack([pixels, opacity])).save(tmp_path / "map.png")
    assert (read_ros_map(path).cells == np.where(usual == FREE, UNKNOWN, usual)).all()


@pytest.mark.parametrize(("mode", "shade"), [("1", 1), ("L", 254), ("I;16", 65535)])
def test_a_transparent_shade_of_grey_is_refused(mode: str, shade: int, tmp_path: Path) -> None:
    path = write_map(tmp_path, floor(), "map.png")
    Image.fromarray(floor()).convert(mode).save(tmp_path / "map.png", transparency=shade)
    with pytest.raises(NomadError, match="a transparent shade of grey: give it an alpha channel"):
        read_ros_map(path)


def test_modes_and_thresholds(tmp_path: Path) -> None:
    pixels = np.array([[0, 100, 150, 205, 255]], dtype=np.uint8)  # darkness 1, .61, .41, .2, 0
    cases: tuple[tuple[dict[str, Any], list[int]], ...] = (
        ({}, [OCCUPIED, UNKNOWN, UNKNOWN, UNKNOWN, FREE]),
        ({"free_thresh": 0.25}, [OCCUPIED, UNKNOWN, UNKNOWN, FREE, FREE]),
        ({"occupied_thresh": 0.5}, [OCCUPIED, OCCUPIED, UNKNOWN, UNKNOWN, FREE]),
        ({"mode": "scale"}, [OCCUPIED, OCCUPIED, FREE, FREE, FREE]),
        ({"mode": "raw"}, [FREE, OCCUPIED, UNKNOWN, UNKNOWN, UNKNOWN]),
    )
    for values, cells in cases:
        read = read_ros_map(write_map(tmp_path, pixels, **values)).cells
        assert read.tolist() == [cells], values


def test_the_part_with_the_goal_becomes_the_room(tmp_path: Path) -> None:
    path = write_map(tmp_path, floor())
    large, small = read_room(path), read_room(path, goal=(5.5, 5.0), starts=3)
    assert large.goal and large.goal[0] < 4.5 and small.goal == (5.5, 5.0)
    assert len(large.starts) == 20 and len(small.starts) == 3
    assert len(large.walls) <= 12
    assert to_mjcf(large) == to_mjcf(read_room(path))


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.0])
def test_rays_hit_where_the_map_says(yaw: float, tmp_path: Path) -> None:
    grid = read_ros_map(write_map(tmp_path, floor(), origin=[-1.0, 2.0, yaw]))
    room = room_of_map(grid, "map")
    model = mujoco.MjModel.from_xml_string(to_mjcf(room))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    free = grid.cells == FREE
    assert room.goal
    for angle in np.linspace(0, 2 * math.pi, 37):
        way = np.array([math.cos(angle), math.sin(angle), 0.0])
        hit = np.zeros(1, dtype=np.int32)
        found = mujoco.mj_ray(model, data, np.array([*room.goal, 0.7]), way, None, 1, -1, hit)
        places = np.array(room.goal) + np.arange(0.0, 12.0, RESOLUTION / 20)[:, None] * way[:2]
        stops = (i for i, place in enumerate(places) if not free[grid.cell_at(place)])
        assert abs(found - next(stops) * RESOLUTION / 20) < RESOLUTION, angle


def test_a_robot_drives_in_it(tmp_path: Path) -> None:
    path = tmp_path / "room.xml"
    path.write_text(to_mjcf(read_room(write_map(tmp_path, floor()))))
    mujoco.MjModel.from_xml_path(str(path))
    with nomad_mj.load("motor", room=path, task_kwargs={"random": 0}) as env:
        assert {"top", "overview"} <= {*env.task.scene.arena.cameras}
        env.reset()
        steps = [env.step([0.3, 0.1, 0.0]) for _ in range(40)]
    sonar = np.array([step.observation["sonar"] for step in steps])
    assert np.isfinite(sonar).all() and sonar.min() < 3


def test_only_what_is_near_the_goal() -> None:
    cells = np.full((400, 400), FREE, dtype=np.uint8)
    cells[::40, ::40] = OCCUPIED
    grid = Occupancy(cells, RESOLUTION, (-10.0, -10.0, 0.0))
    whole, near = room_of_map(grid, "a", (0.5, 0.5)), room_of_map(grid, "a", (0.5, 0.5), 3.0)
    assert len(near.obstacles) < len(whole.obstacles) / 5 and len(near.walls) == 4
    assert np.allclose(near.bounds, (-2.5, -2.5, 3.5, 3.5), atol=0.2)


YAML_MISTAKES = (
    ({"image": "none.pgm"}, "does not exist"),
    ({"image": 3}, "must be the name of a file"),
    ({"resolution": math.nan}, "resolution nan: must be a number from "),
    ({"resolution": 0}, "resolution 0: must be a number from "),
    ({"resolution": 50.0}, "at most 1000 m"),
    ({"origin": [0, 0, math.inf]}, "origin inf: must be a number from "),
    ({"origin": "here"}, "must be a list of 2 to 3 numbers"),
    ({"negate": "maybe"}, "negate 'maybe': must be 0 or 1"),
    ({"occupied_thresh": 65}, "occupied_thresh 65: must be a number from 0 to 1"),
    ({"occupied_thresh": 0.1}, "must not be above occupied_thresh"),
    ({"mode": "colour"}, "there are: trinary, scale, raw"),
    ({"free_thresh": 0.0}, "has no free space"),
)


@pytest.mark.parametrize(("values", "told"), YAML_MISTAKES)
def test_a_mistake_in_a_map_is_told_in_one_line(
    values: dict[str, Any], told: str, tmp_path: Path
) -> None:
    path = write_map(tmp_path, floor())
    held = yaml.safe_load(path.read_text())
    path.write_text(yaml.safe_dump({**held, **values}))
    with pytest.raises(NomadError) as raised:
        read_room(path)
    assert told in str(raised.value) and "\n" not in str(raised.value)


@pytest.mark.parametrize(
    "content", [b"", b"P5\n9 9\n255\nab", b"\x00\xff" * 50, b"P2\n2 2\n255\nx"]
)
def test_damaged_files_are_told_in_one_line(content: bytes, tmp_path: Path) -> None:
    path = write_map(tmp_path, floor())
    (tmp_path / "map.pgm").write_bytes(content)
    (tmp_path / "text.yaml").write_bytes(content)
    for damaged in (path, tmp_path / "text.yaml"):
        with pytest.raises(NomadError) as raised:
            read_room(damaged)
        assert "\n" not in str(raised.value)


def test_a_huge_image_is_refused_before_it_is_read(tmp_path: Path) -> None:
    path = write_map(tmp_path, floor())
    (tmp_path / "map.pgm").write_bytes(b"P5\n60000 60000\n255\n")
    with pytest.raises(NomadError, match=r"at most 16 million|no PGM, PNG or BMP"):
        read_room(path)


@pytest.mark.parametrize("goal", [(0.0, 0.0), (50.0, 2.0), (math.nan, 1.0)])
def test_a_goal_in_something_is_refused(goal: tuple[float, float], tmp_path: Path) -> None:
    with pytest.raises(NomadError) as raised:
        read_room(write_map(tmp_path, floor()), goal=goal)
    assert "\n" not in str(raised.value)
