"""The three learning situations, the backup at the goal, the memory of good actions."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from conftest import See
from known_agent import knowing, output
from nomad_agents.agent import Decision
from nomad_agents.reactive_planner import FAITHFUL, ReactivePlanner, plan

from nomad_mj.perception import Percept
from nomad_mj.types import SensorLayout


def test_what_nothing_matches_is_planned_and_stored(layout: SensorLayout, here: Percept) -> None:
    agent = ReactivePlanner(layout, FAITHFUL)
    best = plan(here, layout.radius, FAITHFUL.situation.grid, FAITHFUL.action, FAITHFUL.planner)
    decision = agent.act(here, np.random.default_rng(0))
    network = agent.network
    assert (decision.kind, decision.category, agent.plannings) == ("planned", 0, 1)
    assert np.array_equal(network.prototype, [best.action])
    assert network.value.tolist() == [best.value] == network.initial_value.tolist()
    assert np.array_equal(network.situation, [here.situation])
    assert decision.action == pytest.approx(output(best.action, decision.drawn))
    assert agent.act(here, np.random.default_rng(0)).kind == "reacted"
    assert agent.plannings == 1


def test_a_much_worse_outcome_calls_the_planner_again(layout: SensorLayout, here: Percept) -> None:
    agent = knowing(layout, here, value=-1.0)
    agent.network.weights[:] = 0.3
    agent._update(here, agent.act(here, None), -0.9, -0.7, collided=False)  # pyright: ignore[reportPrivateUsage]
    network = agent.network
    assert agent.plannings == 1 and len(network.value) == 2
    assert network.category.tolist() == [0, 1]
    assert np.array_equal(network.situation, [here.situation] * 2)
    assert network.weights.tolist() == [[0.3, 0.3], [0.0, 0.0]]  # nothing is tuned
    assert network.value[0] == pytest.approx(-1.0 + 0.075 * -0.6)  # but it falls


def test_an_error_of_just_minus_k_z_is_still_tuned(layout: SensorLayout, here: Percept) -> None:
    agent = knowing(layout, here, value=-1.0)
    agent._update(here, agent.act(here, None), -0.5, -1.0, collided=False)  # pyright: ignore[reportPrivateUsage]
    assert agent.plannings == 0


def test_a_virtual_collision_counts_as_much_worse_and_raises_no_value(
    layout: SensorLayout, here: Percept
) -> None:
    agent = knowing(layout, here, value=-9.0)
    agent.learn(here, agent.act(here, np.random.default_rng(0)), -0.5, True, here)
    assert agent.plannings == 1 and len(agent.network.category) == 2
    assert agent.network.value[0] == -9.0 + 0.075 * -0.5
    better = knowing(layout, here, value=-9.0)
    better._update(here, better.act(here, None), -0.5, -1.0, collided=True)  # pyright: ignore[reportPrivateUsage]
    assert better.network.value[0] == -9.0


def test_no_exemplar_is_added_where_the_planner_returns_what_was_tried(
    layout: SensorLayout, here: Percept
) -> None:
    agent = ReactivePlanner(layout, FAITHFUL)
    decision = agent.act(here, np.random.default_rng(0))
    agent.learn(here, decision, -0.6, True, here)
    assert agent.plannings == 2
    assert len(agent.network.value) == len(agent.network.category) == 1


def two_steps(layout: SensorLayout, see: See, **parameters: Any) -> ReactivePlanner:
    """Return an agent of three categories that went 0, 1, 2 to the goal at -0.2 a step."""
    places = [see((3.0, 0.0)), see((0.0, 2.0)), see((-1.0, -1.0))]
    agent = ReactivePlanner(layout, replace(FAITHFUL, k_dist=0.1, **parameters))
    for place, value in zip(places, (-0.9, -0.75, -0.5), strict=True):
        action = np.array([0.5, 0.25])
        agent.network.add_exemplar(place.situation, agent.network.add_category(action, value))
    agent.start_episode()
    for now, after in pairwise(places):
        agent.learn(now, agent.act(now, np.random.default_rng(1)), -0.2, False, after)
    agent.reach_goal(places[2], agent.act(places[2], np.random.default_rng(1)), -0.2)
    return agent


def test_at_the_goal_values_are_backed_up_in_reverse(layout: SensorLayout, see: See) -> None:
    b = [-0.9, -0.75, -0.5]

    def adjust(j: int, promise: float) -> None:
        error = -0.2 + promise - b[j]
        b[j] += (0.75 if error > 0 else 0.075) * error

    for j, i in ((0, 1), (1, 2)):
        adjust(j, b[i])  # on the way
    adjust(2, 0.0)
    adjust(1, b[2])
    adjust(0, b[1])
    assert two_steps(layout, see).network.value.tolist() == pytest.approx(b)


def test_a_new_episode_forgets_the_path_not_the_lessons(layout: SensorLayout, see: See) -> None:
    agent = two_steps(layout, see)
    before = agent.network.arrays()
    agent.start_episode()
    assert all(np.array_equal(before[k], v) for k, v in agent.network.arrays().items())
    place = see((-1.0, -1.0))
    values = agent.network.value[:2].copy()
    agent.reach_goal(place, agent.act(place, np.random.default_rng(1)), -0.2)
    assert np.array_equal(agent.network.value[:2], values)


def test_good_actions_are_remembered(layout: SensorLayout, here: Percept) -> None:
    for reward, kept in ((-0.91, False), (-0.89, True)):  # 0.1 |b| = 0.1 better than expected
        agent = knowing(layout, here, value=-1.0)
        decision = agent.act(here, np.random.default_rng(0))
        agent._update(here, decision, reward, 0.0, collided=False)  # pyright: ignore[reportPrivateUsage]
        best = agent.network.best_action[0]
        assert np.array_equal(best, decision.action if kept else [0.5, -0.25])


def test_the_backup_at_the_goal_remembers_good_actions_too(layout: SensorLayout, see: See) -> None:
    best = two_steps(layout, see).network.best_action
    assert not np.array_equal(best[1], [0.5, 0.25])


def test_after_a_worse_action_the_memory_teaches_the_output(
    layout: SensorLayout, here: Percept
) -> None:
    agent = knowing(layout, here, value=-1.0, remember_good_actions=True)
    agent.network.best_action[0] = 0.9, -0.6
    agent.network.weights[:] = 0.2
    decision: Decision = agent.act(here, np.random.default_rng(3))
    agent._update(here, decision, -0.6, -0.6, collided=False)  # pyright: ignore[reportPrivateUsage]
    said = output(np.array([0.5, -0.25]), np.full(2, 0.2))
    assert agent.network.weights[0] == pytest.approx(0.2 + 0.2 * (np.array([0.9, -0.6]) - said))
    off = np.abs(agent.network.best_action[0] - agent.act(here, None).action)
    assert (off < np.abs(agent.network.best_action[0] - said)).all()
