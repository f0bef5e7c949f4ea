"""Echoes lost at grazing incidence, in real rooms, against the geometry of the rays."""

import math
import pickle
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj import MotorEnvironment, RangeNoise, load
from nomad_mj.errors import ConfigError
from nomad_mj.perception import SituationSpec, perceive
from nomad_mj.scene import build_scene
from nomad_mj.tasks import MotorConfig, MotorTask
from nomad_mj.types import FloatArray, SensorLayout

OwnRoom = Callable[..., Path]
RingRobot = Callable[..., Path]
ALL = math.pi / 2  # every echo comes back
SONARS = 16


def quiet(
    grazing: float | None, rings: tuple[str, ...] = ("sonar",), **more: Any
) -> dict[str, Any]:
    return {"range_noise": RangeNoise("none", grazing=grazing, specular_rings=rings), **more}


@pytest.fixture(scope="module")
def env() -> Iterator[MotorEnvironment]:
    """A robot without noise in a room of four walls, whose sonar and infrared lose echoes."""
    with_both = quiet(ALL, ("sonar", "infrared"))
    made = load("motor", "empty_room", task_kwargs=with_both)
    yield made
    made.close()


def heard(env: MotorEnvironment, ring: str, rays: int, grazing: float) -> FloatArray:
    """Return what each cone hears of the walls of the empty room, by the geometry of its rays."""
    result: list[float] = []
    data, layout = env.physics.named.data, env.task.scene.robot.layout
    (limits,) = [each for each in layout.rings if each.name == ring]
    for cone in range(SONARS):
        nearest = math.inf
        for ray in range(rays):
            name = f"robot/{ring}_{ray}_{cone:02d}"
            site, along = data.site_xpos[name][:2], data.site_xmat[name][[2, 5]]
            ways = [
                ((10.0 if part > 0 else 0.0) - start) / part if abs(part) > 1e-12 else math.inf
                for start, part in zip(site.tolist(), along.tolist(), strict=True)
            ]
            wall = int(np.argmin(ways))  # 0: one that faces along x, 1: along y
            if math.acos(min(abs(along[wall]), 1.0)) <= grazing:
                nearest = min(nearest, ways[wall])
        from_perimeter = nearest - (layout.radius - 0.23)
        hit = nearest < limits.max_range
        result.append(max(from_perimeter, limits.min_range) if hit else limits.max_range)
    return np.array(result)


# Rays are 7.5 deg apart: angles that no ray of a turret at rest strikes at exactly.
angles = st.integers(1, 22).map(lambda n: math.radians(4.0 * n + 0.7))
places = st.floats(0.5, 9.5)


@settings(max_examples=60)
@given(places, places, angles, st.integers(0, 12))
def test_a_wall_is_heard_where_a_ray_strikes_it_squarely_enough(
    env: MotorEnvironment, x: float, y: float, grazing: float, ticks: int
) -> None:
    env.physics.grazing = grazing
    seen = env.reset(seed=0, start=(x, y)).observation
    for _ in range(ticks):  # the turret turns, and its rays with it
        seen = env.step((0.0, 0.0, 1.5)).observation
    for ring, rays in (("sonar", 5), ("infrared", 3)):
        np.testing.assert_allclose(seen[ring], heard(env, ring, rays, grazing), atol=1e-9)


@settings(max_examples=40)
@given(places, places, angles, angles)
def test_the_more_echoes_are_lost_the_farther_away_things_seem(
    env: MotorEnvironment, x: float, y: float, one: float, other: float
) -> None:
    readings: list[FloatArray] = []
    for grazing in (min(one, other), max(one, other), ALL):
        env.physics.grazing = grazing
        env.reset(seed=0, start=(x, y))
        readings.append(env.task.ranges)
    assert (readings[0] >= readings[1]).all() and (readings[1] >= readings[2]).all()


@pytest.mark.parametrize("away", [0.02, 0.2, 0.55, 2.0, 5.0])
@pytest.mark.parametrize("degrees", [4.0, 15.0, 30.0, 80.0])
def test_a_wall_straight_ahead_reads_as_ever(
    env: MotorEnvironment, away: float, degrees: float
) -> None:
    env.physics.grazing = math.radians(degrees)
    seen = env.reset(start=(10 - 0.265 - away, 5.0)).observation
    assert seen["sonar"][0] == pytest.approx(max(away, 0.15), abs=1e-9)
    assert seen["infrared"][0] == pytest.approx(away if away < 0.56 else 0.6, abs=1e-9)


def readings(room: Path, options: dict[str, Any], start: tuple[float, float]) -> dict[str, Any]:
    with_room = load("motor", room, task_kwargs=options)
    seen = with_room.reset(seed=0, start=start).observation
    with_room.close()
    return seen


def box(turned: float, size: str = "0.5 0.5 1", place: str = "0 0") -> str:
    return (
        f'<geom name="box" type="box" size="{size}" pos="{place} 1" '
        f'euler="0 0 {math.degrees(turned):.9g}"/>'
    )


DEGREES = '<compiler angle="degree"/>'


@pytest.mark.parametrize(
    ("turned", "grazing", "is_heard"),
    [
        (0, 10, True),
        (45, 20, False),
        (45, 29, False),
        (45, 61, True),
        (30, 14, False),
        (30, 31, True),
    ],
)
def test_the_edge_of_a_box_throws_sound_aside(
    own_room: OwnRoom, turned: float, grazing: float, is_heard: bool
) -> None:
    """Its sides lie `turned` to the axis of the cone, whose rays add up to 15 degrees to that."""
    room = own_room(box(math.radians(turned)), head=DEGREES)
    seen = readings(room, quiet(math.radians(grazing)), (-2.0, 0.0))["sonar"]
    edge = 0.5 if turned == 0 else 0.5 * math.sqrt(2) * math.cos(math.radians(45 - turned))
    if is_heard:
        assert 2 - edge - 0.265 - 1e-9 <= seen[0] < 2 - 0.265
    else:
        assert seen[0] > 6.0  # past the box is nothing nearer than the east wall


ROUND = '<geom name="pole" type="cylinder" size="0.1 1" pos="0 0 1"/>'


def test_a_round_pole_always_shows_some_of_itself_squarely(own_room: OwnRoom) -> None:
    for bearing in range(16):
        angle = bearing * math.pi / 8
        start = (-1.2 * math.cos(angle), -1.2 * math.sin(angle))
        seen = readings(own_room(ROUND), quiet(math.radians(5)), start)["sonar"]
        assert seen[bearing] == pytest.approx(1.2 - 0.1 - 0.265, abs=1e-9)


@pytest.mark.parametrize("away", [0.33, 1.0])
def test_a_slanting_wall_vanishes_from_the_sonar_map_but_not_from_the_infrared_near_by(
    own_room: OwnRoom, away: float
) -> None:
    """Sonar 0 meets a wall at 60 degrees, `away` from the perimeter along its axis."""
    place = f"{away + 0.265:.9g} 0"
    wall = box(math.radians(60), "0.001 0.3 1", place)
    cell = 10 + math.ceil((away + 0.265) / 0.2)
    spec = SituationSpec()
    grids: dict[tuple[str, float | None], float] = {}
    for grazing in (None, math.radians(30)):
        options = quiet(grazing)
        with_wall = load("path_finding", own_room(wall, head=DEGREES), task_kwargs=options)
        seen = with_wall.reset(seed=0, start=(0.0, 0.0)).observation
        layout = with_wall.scene.robot.layout
        for ring in layout.rings:
            alone = SensorLayout(layout.radius, (ring,))
            percept = perceive(seen[ring.name], 0.0, np.array([3.0, 3.0]), alone, spec)
            grids[ring.name, grazing] = float(percept.grid[10, cell])
        with_wall.close()
    lossy = math.radians(30)
    assert grids["sonar", None] > 0.9 and grids["sonar", lossy] == 0.0
    told = 1.0 if away < 0.5 else spec.grid.unseen
    assert grids["infrared", None] == grids["infrared", lossy] == pytest.approx(told, abs=0.1)


def drive(options: dict[str, Any], steps: int = 60) -> FloatArray:
    rng = np.random.default_rng(2)
    made = load("motor", "paper_room", task_kwargs={"random": 5, **options})
    seen = [made.reset(seed=5, start=0)]
    seen += [made.step(rng.uniform(-1, 1, 3) * [0.5, 1, 1.5]) for _ in range(steps)]
    made.close()
    return np.array([np.concatenate([*step.observation.values()]) for step in seen])


def test_where_every_echo_comes_back_nothing_changes_to_the_bit() -> None:
    plain = drive({})
    np.testing.assert_array_equal(drive({"range_noise": RangeNoise(grazing=ALL)}), plain)
    lossy = {"range_noise": RangeNoise(grazing=0.3)}
    np.testing.assert_array_equal(drive(lossy), drive(lossy))
    lost = drive(lossy)
    heard_alike = lost[:, :SONARS] == plain[:, :SONARS]
    assert 0.1 < heard_alike.mean() < 0.9
    np.testing.assert_array_equal(lost[:, SONARS:], plain[:, SONARS:])


def test_without_the_option_the_model_reports_nothing_more() -> None:
    plain, lossy = (
        build_scene("empty_room", "nomad200"),
        build_scene("empty_room", "nomad200", specular_rings=("sonar",)),
    )
    assert len(plain.robot.rays.specular) == 0 and len(lossy.robot.rays.specular) == 80
    assert lossy.model.nsensordata - plain.model.nsensordata == 80 * 6
    assert lossy.robot.layout == plain.robot.layout
    np.testing.assert_array_equal(lossy.robot.rays.maximum, plain.robot.rays.maximum)


def test_copies_lose_the_same_echoes(env: MotorEnvironment) -> None:
    env.physics.grazing = 0.3
    env.reset(seed=0, start=(2.0, 3.0))
    there = env.physics.cone_ranges()
    copied, pickled = env.physics.copy(), pickle.loads(pickle.dumps(env.physics))
    for other in (copied, pickled):
        np.testing.assert_array_equal(other.cone_ranges(), there)
        other.grazing = None
        assert (other.cone_ranges() < there).any()
        other.free()


def test_other_numbers_of_rays_lose_echoes_too() -> None:
    made = load("motor", "empty_room", task_kwargs=quiet(0.3, rays_per_cone=9))
    assert len(made.task.scene.robot.rays.specular) == 9 * SONARS
    seen = made.reset(start=(1.2, 5.0)).observation["sonar"]
    assert seen[8] == pytest.approx(1.2 - 0.265) and seen[6] > 4
    made.close()


def test_a_ring_of_any_name_can_lose_echoes(own_room: OwnRoom, ring_robot: RingRobot) -> None:
    robot = ring_robot()
    options = quiet(0.5, ("infrared",))
    made = load("motor", own_room(), robot, task_kwargs=options)
    seen = made.reset(start=(-4.0, 0.0)).observation["infrared"]
    assert seen[4] == pytest.approx(0.8) and seen[3] == seen[5] == 1.5
    made.close()
    with pytest.raises(
        ConfigError, match=r"^specular ring 'sonar': the robot has no such ring; .* infrared$"
    ):
        load("motor", own_room(), robot, task_kwargs=quiet(0.5))


@pytest.mark.parametrize("grazing", [0.0, -0.1, 1.6, math.nan, math.inf])
def test_angles_that_make_no_sense_are_refused(grazing: float) -> None:
    with pytest.raises(ConfigError, match=r"^range noise grazing .*: must be in \(0, pi/2\] rad$"):
        RangeNoise(grazing=grazing)
    with pytest.raises(ConfigError, match=r"^range noise grazing: needs a ring in specular_rings"):
        RangeNoise(grazing=0.3, specular_rings=())


def test_a_scene_that_reports_no_surfaces_is_refused() -> None:
    scene = build_scene("empty_room", "nomad200")
    with pytest.raises(ConfigError, match=r"^range noise grazing: needs a scene .*specular_rings$"):
        MotorTask(scene, MotorConfig(range_noise=RangeNoise(grazing=0.3)))
