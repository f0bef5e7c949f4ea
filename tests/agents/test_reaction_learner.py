"""What the reactive planner's learning is said to have taken."""

from contextlib import nullcontext
from typing import Any

import pytest
from nomad_agents import training as module
from nomad_agents.episode import Episode
from nomad_agents.learners import Lesson, find_learner
from nomad_agents.reactive_planner import ReactivePlanner

from nomad_mj.envs import PathFinding


@pytest.mark.parametrize(("lost", "passes"), [(0, 2), (1, 3)])
def test_hours_and_decisions_are_those_of_learning_alone(
    env: PathFinding, monkeypatch: pytest.MonkeyPatch, lost: int, passes: int
) -> None:
    learnt = tested = 0

    def episode(env: PathFinding, agent: ReactivePlanner, **given: Any) -> Episode:
        nonlocal learnt, tested
        if given.get("explore") is not None:
            learnt += 1
            return Episode(True, 10, 7, 0, 2, 1, 3.0, 4.0, 0.1)
        tested += 1
        return Episode(tested > lost, 5, 5, 0, 9, 9, 100.0, 4.0, 0.1)

    monkeypatch.setattr(module, "run_episode", episode)
    learner, variant = find_learner("reactive_planner")
    lesson = Lesson(variant, 0, 1000, lambda **_: nullcontext(env), {})
    _, row = learner.learn(lesson)
    assert (learnt, tested) == (3 * passes, 3 + lost)
    assert row["learn_sim_s"] == row["sim_s_to_test"] == 3.0 * learnt
    assert row["learn_decisions"] == row["decisions_to_test"] == 10 * learnt
    assert (row["learn_virtual_collisions"], row["learn_bumper_contacts"]) == (2 * learnt, learnt)
    assert row["learn_solved_all"] and "learn_solved" not in row
    monkeypatch.undo()
