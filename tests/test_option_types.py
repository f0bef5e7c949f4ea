"""Options of a wrong type are told in one line that names option and type."""

from collections.abc import Callable
from typing import Any

import pytest
from nomad_agents.deep import SacSettings
from nomad_agents.reactive_planner import ReactivePlannerConfig

import nomad_mj
from nomad_mj import BumperNoise, FiringOrder, Gyroscope, OdometryNoise, RangeNoise, SonarEffects
from nomad_mj.errors import ConfigError
from nomad_mj.gym.reward import RewardOptions
from nomad_mj.motion import ActionSpec, MotionConfig
from nomad_mj.perception import GridSpec

TEXT: Any = "0.1"
HALF: Any = 2.5
FOUR: Any = 4


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: RangeNoise("uniform", TEXT), "RangeNoise 'level': must be a number, not '0.1'"),
        (lambda: OdometryNoise(TEXT), "OdometryNoise 'distance': must be a number"),
        (lambda: BumperNoise(hold=TEXT), "BumperNoise 'hold': must be a number"),
        (lambda: Gyroscope(weight=TEXT), "Gyroscope 'weight': must be a number"),
        (lambda: FiringOrder(HALF), "FiringOrder 'per_step': must be a whole number, not 2.5"),
        (lambda: SonarEffects(firing=FOUR), "'firing': must be a FiringOrder or None, not 4"),
        (lambda: SonarEffects(limits=FOUR), "'limits': must be a tuple, not 4"),
        (lambda: SonarEffects(limits=(TEXT,)), "sonar limits: 0.1 must be above 0 m, or None"),
        (lambda: GridSpec(cells=HALF), "GridSpec 'cells': must be a whole number"),
        (lambda: MotionConfig(ahead=TEXT), "MotionConfig 'ahead': must be a number"),
        (lambda: ActionSpec(longest=TEXT), "ActionSpec 'longest': must be a number"),
        (lambda: RewardOptions(goal_bonus=TEXT), "'goal_bonus': must be a number"),
        (lambda: SacSettings(learning_rate=TEXT), "'learning_rate': must be a number"),
        (lambda: SacSettings(hidden=FOUR), "SacSettings 'hidden': must be a tuple, not 4"),
        (lambda: ReactivePlannerConfig(k_dist=0.0), "k_dist 0.0: must be from 1e-09"),
        (lambda: nomad_mj.load(task_kwargs=FOUR), "task_kwargs: must be a mapping"),
        (lambda: nomad_mj.load_batch(room=FOUR), "room 4: must be one for all worlds, or a list"),
        (lambda: nomad_mj.load_batch(goal=FOUR), "goal 4: must be one for all worlds, or a list"),
    ],
)
def test_a_wrong_type_is_told(make: Callable[[], object], told: str) -> None:
    with pytest.raises(ConfigError) as caught:
        make()
    assert told in str(caught.value) and "\n" not in str(caught.value)


def test_numbers_of_numpy_and_lists_will_do() -> None:
    import numpy as np

    assert RangeNoise("uniform", np.float32(0.5)).level == 0.5  # type: ignore[arg-type]
    assert FiringOrder(np.int64(3)).per_step == 3  # type: ignore[arg-type]
    assert list(SacSettings(hidden=[8, 8]).hidden) == [8, 8]  # type: ignore[arg-type]
