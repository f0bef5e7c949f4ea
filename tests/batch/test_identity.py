"""World by world the batch is the single environment, to the bit."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from identity import BatchEnv, check_same, drawn_actions, singles

from nomad_mj import (
    BumperNoise,
    Crosstalk,
    FiringOrder,
    Gyroscope,
    InfraredEffects,
    MovingGoal,
    OdometryNoise,
    RangeNoise,
    SonarEffects,
    Walkers,
    load_batch,
)

OwnRoom = Callable[..., Path]
STEPS = {"motor": 30, "path_finding": 3}
LIMITS = {"motor": 1.2, "path_finding": 12.0}
NOISY: dict[str, Any] = {
    "range_noise": RangeNoise("gaussian", 0.1, grazing=0.5),
    "odometry_noise": OdometryNoise(0.01, 0.02, 0.01, 0.01, 0.01),
    "sonar": SonarEffects(firing=FiringOrder(), crosstalk=Crosstalk(), dropout=0.1),
    "infrared": InfraredEffects(),
    "bumper_noise": BumperNoise(hold=0.2, sticking=0.1),
    "gyroscope": Gyroscope(),
}
CASES: dict[str, tuple[list[str], str, dict[str, Any]]] = {
    "one room": (["paper_room"] * 3, "nomad200", {}),
    "rooms": (["paper_room", "hall", "clutter", "hall"], "nomad200", {}),
    "noisy": (["paper_room", "clutter"], "nomad200", NOISY),
    "movers": (["moving_room", "hall"], "nomad200", {}),
    "walkers": (
        ["hall"] * 2,
        "nomad200",
        {"moving_obstacles": Walkers(), "moving_goal": MovingGoal()},
    ),
    "wheels": (["clutter", "paper_room"], "nomad200_wheels", {}),
    "differential": (["clutter", "hall"], "pioneer", {}),
    "small": (["concave_room"], "khepera", {}),
    "omni": (["clutter", "moving_room"], "omnibot", {}),
    "car": (["clutter", "hall"], "racer", {}),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("task", LIMITS)
def test_each_world_is_the_single_environment(task: str, case: str) -> None:
    rooms, robot, options = CASES[case]
    environment: dict[str, Any] = {"time_limit": LIMITS[task]}  # short enough for episodes to end
    ones = singles(task, rooms, robot, options, **environment)
    threads = [1, 2] if case in ("one room", "rooms") else [2]
    make: Any = load_batch
    batches: list[BatchEnv] = [
        make(
            task,
            room=rooms,
            robot=robot,
            task_kwargs={**options, "random": 0},
            environment_kwargs=environment,
            threads=count,
        )
        for count in threads
    ]
    alone = [one.reset() for one in ones]
    for many in batches:
        check_same(many.reset(), alone, "reset")
    for number, actions in enumerate(drawn_actions(batches[0], STEPS[task])):
        alone = [one.step(action) for one, action in zip(ones, actions, strict=True)]
        for many in batches:
            check_same(many.step(actions), alone, number)
    for env in (*ones, *batches):
        env.close()


@pytest.mark.parametrize("room", ["paper_room", "moving_room"])
def test_contacts_are_the_same(room: str) -> None:
    """Full speed ahead from every start: into walls, and into what moves."""
    rooms = [room] * 4
    ones = singles("motor", rooms, "nomad200", {"ends_at_goal": False})
    options = {"ends_at_goal": False, "random": 0}
    touched = 0.0
    with load_batch("motor", room=rooms, task_kwargs=options, threads=2) as many:
        starts = [(*many.scenes[0].arena.starts[0][:2], turn) for turn in (0.0, 1.6, 3.1, 4.7)]
        many.reset(starts=starts)
        for one, start in zip(ones, starts, strict=True):
            one.reset(start=start)
        speeds = np.tile([0.6, 0.0, 0.0], (4, 1))
        for number in range(150):
            told = many.step(speeds)
            check_same(told, [one.step(speeds[0]) for one in ones], number)
            touched += told.observation["bumpers"].sum()
    assert touched
    for one in ones:
        one.close()


def test_goals_and_large_rooms_are_the_same(own_room: OwnRoom) -> None:
    boxes = "".join(
        f'<geom type="box" size="0.1 0.1 0.5" pos="{-4 + x} {-4.5 + y} 0.5"/>'
        for x in range(9)
        for y in range(9)
        if (x, y) not in ((1, 1), (7, 7))
    )
    rooms = [own_room(boxes), "empty_room", "empty_room", own_room(boxes)]
    goals = [None, (2.0, 3.0), None, (3.0, 2.6)]
    ones = singles("motor", rooms, "nomad200", {}, goals)
    with load_batch("motor", room=rooms, goal=goals, task_kwargs={"random": 0}, threads=2) as many:
        check_same(many.reset(), [one.reset() for one in ones], "reset")
        speeds = np.tile([0.6, 0.3, 0.0], (4, 1))
        for number in range(40):
            told = many.step(speeds)
            check_same(told, [one.step(speeds[0]) for one in ones], number)
    for one in ones:
        one.close()


def test_each_world_simulates_what_is_near_its_own_robot(wide_room: Path) -> None:
    rooms, starts = [wide_room] * 3, [(2.0, 2.0, 0.0), (20.0, 15.0, 0.0), (25.0, 24.0, 2.0)]
    options = {"ends_at_goal": False, "infrared": InfraredEffects(("sonar",))}
    ones = singles("motor", rooms, "nomad200", options)
    with load_batch("motor", room=rooms, task_kwargs={**options, "random": 0}) as many:
        assert many.scenes[0].near_model is not None
        for begin in (starts, starts[1:] + starts[:1]):
            first = [one.reset(start=start) for one, start in zip(ones, begin, strict=True)]
            check_same(many.reset(starts=begin), first, "reset")
            touched = 0.0
            for number in range(90):
                speeds = np.tile([0.6, 0.0, 0.1], (3, 1))
                told = many.step(speeds)
                check_same(told, [one.step(speeds[0]) for one in ones], number)
                touched += told.observation["bumpers"].sum()
            assert touched
    for one in ones:
        one.close()
