"""Infrared sensors that judge distance by the light that comes back."""

import math
import pickle
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj import InfraredEffects, MotorEnvironment, RangeNoise, load
from nomad_mj.errors import ConfigError

OwnRoom = Callable[..., Path]
QUIET = RangeNoise("none")
OUTSIDE = 0.265 - 0.23  # from a ray's site out to the perimeter [m]
BOXES = """
<geom name="red" type="box" size="0.1 1 1" pos="-2 3 1" rgba="1 0 0 1"/>
<geom name="paint" type="box" size="0.1 1 1" pos="2 3 1" material="paint"/>
<geom name="both" type="box" size="0.1 1 1" pos="-2 -3 1" material="paint" rgba="0 0 0 1"/>
<geom name="plain" type="box" size="0.1 1 1" pos="2 -3 1"/>
"""
PAINT = '<asset><material name="paint" rgba="0.9 0.9 0.9 1"/></asset>'
LUMINANCES = {(-2, 3): 0.2126, (2, 3): 0.9, (-2, -3): 0.01, (2, -3): 0.5}


@pytest.fixture(scope="module")
def room(own_room: OwnRoom) -> Path:
    return own_room(BOXES, head=PAINT)


@pytest.fixture(scope="module")
def env(room: Path) -> Iterator[MotorEnvironment]:
    options = {"range_noise": QUIET, "infrared": InfraredEffects(reference=0.9)}
    made = load("motor", room, task_kwargs=options)
    yield made
    made.close()


@settings(max_examples=60)
@given(st.sampled_from([*LUMINANCES]), st.floats(0.02, 0.55))
def test_a_dark_obstacle_seems_farther_by_the_root_of_what_it_sends_back(
    env: MotorEnvironment, box: tuple[int, int], away: float
) -> None:
    x, y = box
    seen = env.reset(seed=0, start=(x + 0.1 + 0.265 + away, y)).observation
    seems = (away + OUTSIDE) * math.sqrt(0.9 / LUMINANCES[box])
    wanted = seems - OUTSIDE if seems < 0.6 else 0.6
    assert seen["infrared"][8] == pytest.approx(wanted, abs=1e-6)  # colours are single precision
    assert seen["sonar"][8] == pytest.approx(max(away, 0.15), abs=1e-9)


def test_rays_are_cast_again_as_the_engine_cast_them(room: Path) -> None:
    """With a reference of what the plain box has, its readings are those without the option."""
    rng = np.random.default_rng(0)
    made = [
        load("motor", room, task_kwargs={"infrared": effects, "range_noise": QUIET})
        for effects in (None, InfraredEffects(reference=0.5))
    ]
    nears = 0
    for _ in range(40):
        start = (2.45 + rng.uniform(0, 0.3), -3 + rng.uniform(-1.3, 1.3), rng.uniform(-3, 3))
        seen = [each.reset(seed=0, start=start).observation["infrared"] for each in made]
        command = rng.uniform(-1, 1, 3) * [0.3, 1.0, 1.5]
        seen += [each.step(command).observation["infrared"] for each in made]
        np.testing.assert_allclose(seen[0], seen[1], atol=1e-7)
        np.testing.assert_allclose(seen[2], seen[3], atol=1e-7)
        nears += (seen[0] < 0.6).sum()
    assert nears > 60
    for each in made:
        each.close()


def test_a_cone_reads_what_seems_nearest_not_what_is(own_room: OwnRoom) -> None:
    """A black post straight ahead in a cone's middle ray, before a white wall."""
    post = '<geom name="post" type="box" size="0.01 0.01 1" pos="0.6 0 1" rgba="0 0 0 1"/>'
    wall = '<geom name="board" type="box" size="0.1 2 1" pos="0.85 0 1" rgba="1 1 1 1"/>'
    options = {"range_noise": QUIET, "infrared": InfraredEffects(reference=1.0)}
    with load("motor", own_room(post + wall), task_kwargs=options) as made:
        seen = made.reset(seed=0, start=(0.0, 0.0)).observation["infrared"]
        beside = (0.75 / math.cos(math.radians(15))) - 0.265
        assert seen[0] == pytest.approx(beside, abs=0.01) and seen[0] > 0.75 - 0.265


def test_copies_see_the_same(env: MotorEnvironment) -> None:
    env.reset(seed=0, start=(2.6, 3.0))
    there = env.physics.cone_ranges()
    for other in (env.physics.copy(), pickle.loads(pickle.dumps(env.physics))):
        np.testing.assert_array_equal(other.cone_ranges(), there)
        other.infrared = None
        assert (other.cone_ranges()[16:] < 0.5).any()
        other.free()


def test_only_the_infrared_ring_changes() -> None:
    seen = []
    for effects in (None, InfraredEffects()):
        made = load("motor", "paper_room", task_kwargs={"random": 1, "infrared": effects})
        step = made.reset(seed=1, start=(0.6, 5.0))
        seen.append(np.concatenate([*step.observation.values()]))
        made.close()
    changed = np.flatnonzero(seen[0] != seen[1])
    assert len(changed) and changed.min() >= 16 and changed.max() < 32
    assert (seen[1] >= seen[0])[16:32].all()


@pytest.mark.parametrize("reference", [0.0, -1.0, 1.1, math.nan])
def test_what_makes_no_sense_is_refused(reference: float) -> None:
    with pytest.raises(ConfigError, match=r"^infrared reference .*: must be in \(0, 1\]$"):
        InfraredEffects(reference=reference)
    with pytest.raises(ConfigError, match=r"^infrared effects: need a ring in rings$"):
        InfraredEffects(())


def test_a_robot_without_such_a_ring_is_refused(own_room: OwnRoom) -> None:
    options = {"infrared": InfraredEffects(("light",))}
    with pytest.raises(ConfigError, match=r"^infrared ring 'light': .* has: sonar, infrared$"):
        load("motor", own_room(), task_kwargs=options)
