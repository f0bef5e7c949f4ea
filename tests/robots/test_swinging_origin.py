"""A robot whose axle is not under its origin: the origin still ends where a move should."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from nomad_mj import Outcome, load


@pytest.mark.parametrize("turn", [0, 45, 90, -120, 180])
@pytest.mark.parametrize("back", [0.0, 0.1])
def test_a_move_ends_where_it_should_whatever_the_turn(
    cart: Callable[..., Path], turn: int, back: float
) -> None:
    wheels = [
        (f'name="wheel_{side}" pos="0 {y} 0"', f'name="wheel_{side}" pos="{-back} {y} 0"')
        for side, y in (("l", 0.125), ("r", -0.125))
    ]
    castor = ("-0.1 0 -0.03", f"{-0.1 - back} 0 -0.03")
    with load("path_finding", "empty_room", cart(*wheels, castor), {"random": 0}) as env:
        start = np.array([4.0, 5.0])
        env.reset(seed=0, start=start.tolist())
        x, y = env.motor.task.goal - start
        to_goal = np.array([[x, y], [-y, x]]) / math.hypot(x, y)
        wanted = 0.6 * np.array([math.cos(math.radians(turn)), math.sin(math.radians(turn))])
        step = env.step(to_goal @ wanted)
        assert step.observation["outcome"] == Outcome.MOVED
        off = np.array(env.physics.pose()[:2]) - start - wanted
        assert math.hypot(*off) < 0.03
