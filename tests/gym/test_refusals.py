"""Whatever is wrong is told in one line that says what would be right."""

import re
from typing import Any

import gymnasium
import numpy as np
import pytest

from nomad_mj.errors import NomadError
from nomad_mj.gym.registration import MOTOR, PATH_FINDING

WRONG: list[tuple[str, dict[str, Any], str]] = [
    (PATH_FINDING, {"room": "attic"}, "unknown room 'attic'; there are: clutter, "),
    (PATH_FINDING, {"robot": "rover"}, "unknown robot 'rover'; there are: "),
    (PATH_FINDING, {"observation": "image"}, "unknown observation 'image'; there are: situation, "),
    (MOTOR, {"observation": "situation"}, "unknown observation 'situation'; there are: ranges, "),
    (PATH_FINDING, {"reward": "dense"}, "reward 'dense': must be 'task' or 'sparse'"),
    (PATH_FINDING, {"goal_bonus": float("nan")}, "goal_bonus nan: must be a finite number"),
    (PATH_FINDING, {"time_limit": 0.0}, "time limit 0.0: must be above 0 s"),
    (PATH_FINDING, {"view": "below"}, "unknown view 'below'; there are: "),
    (PATH_FINDING, {"width": 64}, "picture 64 x None: give width and height, or neither"),
    (PATH_FINDING, {"task_kwargs": {"nois": 1}}, "unknown task option 'nois'; there are: "),
    (
        PATH_FINDING,
        {"task_kwargs": {"range_noise": {"levl": 0.1}}},
        r"task option 'range_noise': is no RangeNoise: .*levl",
    ),
    (
        MOTOR,
        {"task_kwargs": {"range_noise": {"level": 2.0}}},
        r"range noise level 2.0: must be in \[0, 1\)",
    ),
    (PATH_FINDING, {"situation": {"width": 0.0}}, "width 0.0: must be from 1e-09 to 1e"),
    (PATH_FINDING, {"situation": {"grid": {"cells": 20}}}, "cells 20: must be odd"),
    (PATH_FINDING, {"situation": {"grid": {"cells": 3}}}, "cells 3: must be 9 or more"),
    (PATH_FINDING, {"situation": {"grid": {"cells": -3}}}, "cells -3: must be from 1 to 401"),
    (PATH_FINDING, {"situation": {"grid": {"resolution": 0}}}, "resolution 0.0: must be from"),
    (PATH_FINDING, {"situation": "circular"}, "situation: must be a SituationSpec, or a mapping"),
    (PATH_FINDING, {"situation": {"width": "wide"}}, "situation: is no SituationSpec: .*width"),
]


@pytest.mark.parametrize(("name", "options", "told"), WRONG)
def test_options(name: str, options: dict[str, Any], told: str) -> None:
    with pytest.raises(NomadError, match=f"^{told}") as error:
        made: dict[str, Any] = {"robot": "khepera", **options}
        gymnasium.make(name, **made)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"start": 99}, "start 99: the room's are numbered 0 to 49"),
        ({"start": "nowhere"}, "unknown start 'nowhere'; there are: "),
        ({"start": (0.0, 0.0)}, "start (0, 0) is "),
        ({"begin": 3}, "unknown reset option 'begin'; there is: start"),
    ],
)
def test_starts_leave_the_environment_usable(options: dict[str, Any], told: str) -> None:
    env = gymnasium.make(PATH_FINDING, robot="khepera")
    with pytest.raises(NomadError, match=f"^{re.escape(told)}"):
        env.reset(seed=0, options=options)
    env.reset(seed=0, options={"start": [5.0, 2.0, 1.5]})
    assert env.get_wrapper_attr("physics").pose() == pytest.approx((5.0, 2.0, 1.5))
    env.close()


@pytest.mark.parametrize("action", [[1.0], [np.nan, 0.0], [[0.0, 1.0]]])
def test_actions(action: Any) -> None:
    env = gymnasium.make(PATH_FINDING, robot="khepera", disable_env_checker=True)
    env.reset(seed=0)
    with pytest.raises(ValueError, match=r"must be 2 finite numbers in \[-1, 1\]$"):
        env.step(np.array(action))
    env.close()
