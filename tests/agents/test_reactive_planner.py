"""The reactive planner's decisions and learning, against the paper's equations by hand."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import See
from hypothesis import given
from hypothesis import strategies as st
from known_agent import knowing, output, shifted
from nomad_agents.reactive_planner import FAITHFUL, ReactivePlanner, estimate_value

from nomad_mj.perception import Percept
from nomad_mj.types import FloatArray, SensorLayout


def test_action_units_sum_weights_and_squash(layout: SensorLayout, here: Percept) -> None:
    agent = knowing(layout, here)
    other = agent.network.add_category(np.array([1.0, 1.0]), -9.0)
    agent.network.add_exemplar(here.situation, other)
    agent.network.weights[:] = [[0.8, -1.5], [50.0, 50.0]]
    decision = agent.act(shifted(here, 0.3), None)
    mean = np.exp(-0.3) * np.array([0.8, -1.5])  # of the winner's exemplars alone (Eq 12)
    assert decision.mean == pytest.approx(mean)
    assert np.array_equal(decision.drawn, decision.mean)  # no exploration
    assert decision.action == pytest.approx(output(np.array([0.5, -0.25]), mean))
    assert (decision.kind, decision.category, decision.unmatched) == ("reacted", 0, False)


@given(st.floats(-1e3, 1e3), st.floats(-1, 1))
def test_an_action_stays_in_its_range(level: float, prototype: float) -> None:
    agent = ReactivePlanner(SensorLayout(0.2, ()), FAITHFUL)
    agent.network.add_category(np.full(2, prototype), 0.0)
    percept = Percept(np.zeros(26), np.zeros((21, 21)), np.ones(2))
    agent.network.add_exemplar(percept.situation, 0)
    agent.network.weights[:] = level
    action = agent.act(percept, None).action
    assert (np.abs(action) <= 1).all()
    assert ((action - prototype) * level >= 0).all()


def test_exploration_is_drawn_around_the_mean_as_broad_as_the_trace(
    layout: SensorLayout, here: Percept
) -> None:
    agent = knowing(layout, here, k_sigma=0.5)
    agent.network.weights[:] = [[0.8, -1.5]]
    agent.network.trace[:] = 1.4
    drawn = np.array([agent.act(here, np.random.default_rng(i)).drawn for i in range(2000)])
    assert drawn.mean(axis=0) == pytest.approx([0.8, -1.5], abs=0.06)
    assert drawn.std(axis=0) == pytest.approx([0.7, 0.7], abs=0.04)  # k_sigma h (Eq 13)
    decision = agent.act(here, np.random.default_rng(0))
    assert decision.action == pytest.approx(output(agent.network.prototype[0], decision.drawn))
    agent.network.trace[:] = 0.0
    drawn = np.array([agent.act(here, np.random.default_rng(i)).drawn for i in range(500)])
    assert drawn.std(axis=0) == pytest.approx([0.02, 0.02], rel=0.15)  # the floor


@pytest.mark.parametrize(("reward", "rate"), [(-0.1, 0.75), (-0.9, 0.075)])
def test_values_learn_at_one_rate_from_reward_and_another_from_penalty(
    layout: SensorLayout, here: Percept, reward: float, rate: float
) -> None:
    agent = knowing(layout, here, value=-2.5, k_dist=0.3)
    next_ = agent.network.add_category(np.array([1.0, 0.0]), -2.0)
    after = shifted(here, 0.5)
    agent.network.add_exemplar(after.situation, next_)
    agent.network.trace[0] = 0.4
    error = reward - 2.0 + 2.5
    agent.learn(here, agent.act(here, np.random.default_rng(0)), reward, False, after)
    assert agent.network.value.tolist() == pytest.approx([-2.5 + rate * error, -2.0])
    assert agent.network.trace[0] == pytest.approx(0.75 * abs(error) + 0.25 * 0.4)  # Eq 14
    assert agent.network.initial_value[0] == -2.5


def test_an_unknown_place_is_worth_what_the_planner_estimates(
    layout: SensorLayout, here: Percept, see: See
) -> None:
    agent = knowing(layout, here, value=-4.0)
    after = see((1.0, 2.0), np.linspace(0.3, 2.0, 16))
    promise = float(
        estimate_value(np.zeros((1, 2)), after, FAITHFUL.situation.grid, FAITHFUL.planner)[0]
    )
    agent.learn(here, agent.act(here, np.random.default_rng(0)), -0.2, False, after)
    error = -0.2 + promise + 4.0
    assert agent.network.trace[0] == pytest.approx(0.75 * abs(error))


def log_likelihood(weights: FloatArray, a: FloatArray, drawn: FloatArray, sigma: float) -> float:
    mean = a @ weights
    return float((-((drawn - mean) ** 2) / (2 * sigma**2) - np.log(sigma)).sum())


@pytest.mark.parametrize(("reward", "rate"), [(-0.05, 0.2), (-0.7, 0.02)])
def test_weights_follow_the_gradient_of_the_log_likelihood(
    layout: SensorLayout, here: Percept, reward: float, rate: float
) -> None:
    agent = knowing(layout, here, value=-0.6)
    network = agent.network
    network.add_exemplar(shifted(here, 0.4).situation, 0)
    network.add_exemplar(shifted(here, 3.0).situation, 0)  # not active: stays as it is
    network.weights[:] = [[0.3, -0.2], [0.1, 0.5], [1.0, 1.0]]
    network.trace[0] = 0.7
    before, places = network.weights.copy(), network.situation.copy()
    decision = agent.act(here, np.random.default_rng(5))
    agent._update(here, decision, reward, 0.0, collided=False)  # pyright: ignore[reportPrivateUsage]
    error = reward + 0.6
    sigma = 0.75 * abs(error) + 0.25 * 0.7  # after the error was taken in
    a = np.array([1.0, np.exp(-0.4), 0.0])
    gradient = np.zeros_like(before)
    for i in np.ndindex(*before.shape):
        step = np.zeros_like(before)
        step[i] = 1e-6
        up = log_likelihood(before + step, a, decision.drawn, sigma)
        down = log_likelihood(before - step, a, decision.drawn, sigma)
        gradient[i] = (up - down) / 2e-6
    assert network.weights == pytest.approx(before + rate * error * gradient, abs=1e-7)
    off = here.situation - places
    assert network.situation == pytest.approx(places + 0.1 * a[:, None] * off)  # Eq 21
    assert np.array_equal(network.situation[2], places[2])


@pytest.mark.parametrize(("no_match", "kind"), [("plan", "planned"), ("stay", "none")])
def test_without_learning_the_unknown_is_owned_up_to(
    layout: SensorLayout, here: Percept, see: See, no_match: str, kind: str
) -> None:
    agent = knowing(layout, here, no_match=no_match)
    decision = agent.act(see((-4.0, -4.0), 0.3), None)
    assert (decision.kind, decision.category, decision.unmatched) == (kind, -1, True)
    assert agent.plannings == 0 and len(agent.network.category) == 1


def test_without_learning_the_nearest_exemplar_can_be_trusted(
    layout: SensorLayout, here: Percept, see: See
) -> None:
    far = see((-4.0, -4.0), 0.3)
    decision = knowing(layout, here, no_match="nearest").act(far, None)
    assert (decision.kind, decision.category, decision.unmatched) == ("reacted", 0, True)
    empty = ReactivePlanner(layout, replace(FAITHFUL, no_match="nearest"))
    assert empty.act(far, None).kind == "none"
