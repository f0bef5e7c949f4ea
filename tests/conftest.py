"""What all tests share: the `gl` marker, how hypothesis runs, and files of a user's own."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

from nomad_mj._gl import gl_report

# A deadline measures the machine's other work, not the code.
settings.register_profile("local", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "local")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "gl: draws a picture; skipped where no OpenGL works")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    report = gl_report()
    if report.works:
        return
    skip = pytest.mark.skip(reason=report.message)
    for item in items:
        if item.get_closest_marker("gl"):
            item.add_marker(skip)


WALLS = """
<geom name="wall_north" type="box" size="5 0.1 0.5" pos="0 5.1 0.5"/>
<geom name="wall_south" type="box" size="5 0.1 0.5" pos="0 -5.1 0.5"/>
<geom name="wall_east" type="box" size="0.1 5 0.5" pos="5.1 0 0.5"/>
<geom name="wall_west" type="box" size="0.1 5 0.5" pos="-5.1 0 0.5"/>
<site name="goal" pos="3 3 0"/>
<site name="start_0" pos="-3 -3 0"/>
"""
RingRobot = Callable[..., Path]
OwnRoom = Callable[..., Path]


@pytest.fixture(scope="session")
def ring_robot(tmp_path_factory: pytest.TempPathFactory) -> RingRobot:
    """Return a writer of robots with one ring of single rays at `bearings` [deg].

    Each pair of `edits` replaces the first text, which must be there, by the second.
    """

    def write(
        bearings: Sequence[float] = range(0, 360, 45),
        *edits: tuple[str, str],
        ring: str = "infrared",
        name: str = "puck",
    ) -> Path:
        sites = sensors = ""
        for number, bearing in enumerate(bearings):
            site = f'<site name="{ring}_{number}" pos="0.15 0 0" zaxis="1 0 0"/>'
            sites += f'<frame euler="0 0 {bearing!r}">{site}</frame>'
            sensors += f'<rangefinder name="{ring}_{number}" site="{ring}_{number}" cutoff="1.5"/>'
        text = (Path(__file__).parent / "ring_robot.xml").read_text()
        text = text.replace("        RING", sites).replace("    SENSORS", sensors)
        for old, new in edits:
            assert old in text, old
            text = text.replace(old, new)
        path = tmp_path_factory.mktemp("robots") / f"{name}.xml"
        path.write_text(text)
        return path

    return write


@pytest.fixture(scope="session")
def own_room(tmp_path_factory: pytest.TempPathFactory) -> OwnRoom:
    """Return a writer of 10 x 10 m rooms about the origin: with more in them, or edited."""

    def write(body: str = "", *edits: tuple[str, str], head: str = "", name: str = "own") -> Path:
        text = f"<mujoco>{head}<worldbody>{WALLS}{body}</worldbody></mujoco>"
        for old, new in edits:
            assert old in text, old
            text = text.replace(old, new)
        path = tmp_path_factory.mktemp("rooms") / f"{name}.xml"
        path.write_text(text)
        return path

    return write


@pytest.fixture(scope="session")
def wide_room(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a room of 30 x 30 m with a post every two metres: most is far from any robot."""
    side = 30.0
    places = np.arange(3.0, side - 1, 2)
    posts = "".join(
        f'<geom type="cylinder" size="0.15 0.45" pos="{x} {y} 0.45"/>'
        for x in places
        for y in places
    )
    walls = "".join(
        f'<geom type="box" size="{a} {b} 0.45" pos="{x} {y} 0.45"/>'
        for x, y, a, b in (
            (15, -0.1, 15.2, 0.1),
            (15, side + 0.1, 15.2, 0.1),
            (-0.1, 15, 0.1, 15.2),
            (side + 0.1, 15, 0.1, 15.2),
        )
    )
    path = tmp_path_factory.mktemp("wide") / "wide.xml"
    path.write_text(
        f"<mujoco><worldbody>{walls}{posts}<site name='goal' pos='28 28 0'/>"
        "<site name='start_0' pos='2 2 0'/><camera name='top' pos='15 15 39.8' fovy='45'/>"
        "</worldbody></mujoco>"
    )
    return path
