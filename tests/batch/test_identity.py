"""World by world the batch is the single environment, to the bit."""

from typing import Any

import pytest
from identity import check_same, drawn_actions, singles

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

STEPS = {"motor": 45, "path_finding": 4}
NOISY: dict[str, Any] = {
    "range_noise": RangeNoise("gaussian", 0.1, grazing=0.5),
    "odometry_noise": OdometryNoise(0.01, 0.02, 0.01, 0.01, 0.01),
    "sonar": SonarEffects(firing=FiringOrder(), crosstalk=Crosstalk(), dropout=0.1),
    "infrared": InfraredEffects(),
    "bumper_noise": BumperNoise(hold=0.2, sticking=0.1),
    "gyroscope": Gyroscope(),
}
CASES: dict[str, tuple[list[str], str, dict[str, Any]]] = {
    "one room": (["paper_room"] * 4, "nomad200", {}),
    "rooms": (["paper_room", "hall", "corridor", "clutter", "hall"], "nomad200", {}),
    "noisy": (["paper_room", "clutter", "paper_room"], "nomad200", NOISY),
    "movers": (["moving_room", "moving_room", "hall"], "nomad200", {}),
    "walkers": (
        ["hall"] * 3,
        "nomad200",
        {"moving_obstacles": Walkers(), "moving_goal": MovingGoal()},
    ),
    "wheels": (["clutter", "paper_room"], "nomad200_wheels", {}),
    "differential": (["clutter", "hall"], "pioneer", {}),
    "small": (["concave_room"], "khepera", {}),
    "omni": (["clutter", "moving_room"], "omnibot", {}),
    "car": (["clutter", "hall"], "racer", {}),
}


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("task", STEPS)
def test_each_world_is_the_single_environment(task: str, case: str, threads: int) -> None:
    rooms, robot, options = CASES[case]
    ones = singles(task, rooms, robot, options, time_limit=40.0 if task == "path_finding" else 1.5)
    environment = {"time_limit": 40.0 if task == "path_finding" else 1.5}
    with load_batch(  # type: ignore[call-overload]
        task,
        room=rooms,
        robot=robot,
        task_kwargs={**options, "random": 0},
        environment_kwargs=environment,
        threads=threads,
    ) as many:
        check_same(many.reset(), [one.reset() for one in ones], "reset")
        for number, actions in enumerate(drawn_actions(many, STEPS[task])):
            alone = [one.step(action) for one, action in zip(ones, actions, strict=True)]
            check_same(many.step(actions), alone, number)
    for one in ones:
        one.close()
