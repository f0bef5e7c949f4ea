"""The modular network: Eqs 9-10, the rule of k_ind, categories on demand, growth."""

import copy
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nomad_agents.reactive_planner import FAITHFUL, TUNED, Network

EAST = np.array([1.0, 0.0])
NORTH = np.array([0.0, 1.0])


def line(*exemplars: tuple[float, int], values: tuple[float, ...]) -> Network:
    """Return a network of exemplars at places on a line, each of a category with a value."""
    network = Network(1)
    for value in values:
        network.add_category(EAST, value)
    for place, category in exemplars:
        network.add_exemplar(np.array([place]), category)
    return network


def test_parameters_are_those_of_table_1() -> None:
    c, p = FAITHFUL, FAITHFUL.planner
    assert c.situation.width == 0.35 and c.action.shortest == 0.01
    assert (p.k_clear, p.k_length, p.k_rep, p.k_alpha) == (0.1, 0.75, 0.25, np.radians(45))
    assert (c.k_dist, c.k_ind, c.k_z, c.beta, c.xi, c.k_sigma) == (1.0, 0.1, 0.5, 0.4, 0.75, 1.0)
    assert (c.epsilon, c.alpha_reward, c.alpha_penalty) == (0.1, 0.2, 0.02)
    assert (c.eta_reward, c.eta_penalty) == (0.75, 0.075)
    assert c.situation.grid.cells == 21 and c.situation.grid.resolution == 0.2
    assert c.situation.grid.perception_range == 2.0 and c.action.longest == 1.0
    assert not c.remember_good_actions and c.no_match == "plan"


def test_tuned_keeps_the_equations_but_other_numbers() -> None:
    assert (TUNED.k_ind, TUNED.no_match, TUNED.situation.circular) == (0.02, "plan", True)
    assert (TUNED.planner.margin, FAITHFUL.planner.margin) == (0.25, 0.15)
    assert TUNED.action == FAITHFUL.action


def through_a_pickle(network: Network) -> Network:
    return pickle.loads(pickle.dumps(network))


@pytest.mark.parametrize("clone", [copy.deepcopy, through_a_pickle])
def test_a_copy_learns_on_as_the_first_would(clone: Callable[[Network], Network]) -> None:
    first = line((0.0, 0), (0.5, 1), values=(-1.0, -2.0))
    other = clone(first)
    for network in (first, other):
        network.value[0] = -5.0
        network.situation[1] += 0.25
        network.add_exemplar(np.full(network.situation.shape[1], 0.75), 1)
        network.add_category(np.zeros(2), -3.0)
    for name, array in first.arrays().items():
        np.testing.assert_array_equal(other.arrays()[name], array)
    assert other.value[0] == -5.0
    other.value[0] = -6.0
    assert first.value[0] == -5.0, "what one learns the other does not"


def test_nothing_is_known_at_first() -> None:
    match = Network(3).classify(np.zeros(3), 1.0, 0.1)
    assert match.category == -1 and match.activation.shape == (0,)
    assert Network(3).nearest(np.zeros(3)).category == -1


@pytest.mark.parametrize(
    ("distance", "output"), [(0.0, 1.0), (0.5, np.exp(-0.5)), (0.999, np.exp(-0.999)), (1.0, 0.0)]
)
def test_an_exemplar_answers_exp_of_minus_its_distance_below_k_dist(
    distance: float, output: float
) -> None:
    match = line((distance, 0), values=(-1.0,)).classify(np.zeros(1), 1.0, 0.1)
    assert match.activation == pytest.approx([output])
    assert match.category == (0 if output else -1)


def test_the_distance_is_euclidean() -> None:
    network = Network(2)
    network.add_exemplar(np.array([0.3, 0.4]), network.add_category(EAST, 0.0))
    assert network.classify(np.zeros(2), 1.0, 0.0).activation == pytest.approx([np.exp(-0.5)])


def test_the_most_active_category_wins_beyond_k_ind() -> None:
    network = line((0.0, 0), (0.2, 1), values=(-9.0, -1.0))  # outputs 1 and 0.819
    assert network.classify(np.zeros(1), 1.0, 0.1).category == 0


def test_within_k_ind_the_most_valuable_category_wins() -> None:
    network = line((0.0, 0), (0.09, 1), (0.05, 2), values=(-9.0, -1.0, -4.0))
    assert network.classify(np.zeros(1), 1.0, 0.1).category == 1
    assert network.classify(np.zeros(1), 1.0, 0.0).category == 0


def test_a_category_is_as_active_as_its_closest_exemplar() -> None:
    network = line((0.9, 1), (0.0, 1), (0.05, 0), values=(-3.0, -2.0))
    assert network.classify(np.zeros(1), 1.0, 0.1).category == 1


def test_of_equal_rivals_one_wins_and_always_the_same() -> None:
    network = line((0.5, 0), (-0.5, 1), values=(-1.0, -1.0))
    assert {network.classify(np.zeros(1), 1.0, 0.1).category for _ in range(9)} == {0}


def test_k_ind_lets_no_category_win_that_does_not_match() -> None:
    network = line((0.95, 0), (1.5, 1), values=(-9.0, 0.0))
    assert network.classify(np.zeros(1), 1.0, 1.0).category == 0


@given(st.integers(0, 2**32), st.integers(1, 40), st.floats(0.3, 3.0), st.floats(0.0, 1.0))
def test_the_winner_is_that_of_the_definition(
    seed: int, exemplars: int, k_dist: float, k_ind: float
) -> None:
    rng = np.random.default_rng(seed)
    network = Network(4)
    for value in rng.uniform(-5, 0, 6):
        network.add_category(EAST, float(value))
    for _ in range(exemplars):
        network.add_exemplar(rng.uniform(0, 1, 4), int(rng.integers(6)))
    situation = rng.uniform(0, 1, 4)
    active: dict[int, float] = {}
    for place, owner in zip(network.situation, network.category.tolist(), strict=True):
        x = float(np.linalg.norm(place - situation))
        active[owner] = max(active.get(owner, 0.0), float(np.exp(-x)) if x < k_dist else 0.0)
    top = max(active.values())
    rivals = {j for j, a in active.items() if a > 0 and a >= top - k_ind}
    won = network.classify(situation, k_dist, k_ind).category
    assert won == (max(rivals, key=lambda j: network.value[j]) if rivals else -1)


def test_the_nearest_exemplar_answers_however_far_it_is() -> None:
    network = line((8.0, 0), (9.0, 1), values=(-9.0, 0.0))
    match = network.nearest(np.zeros(1))
    assert match.category == 0 and match.activation[0] == pytest.approx(np.exp(-8))


def test_a_plan_belongs_to_a_category_of_its_action_and_its_initial_value() -> None:
    network = Network(1)
    for action, value in ((EAST, -2.0), (EAST, -1.0), (NORTH, -1.4)):
        network.add_category(action, value)
    assert network.find_category(EAST, -1.4, 0.5) == 1
    assert network.find_category(EAST, -1.6, 0.5) == 0
    assert network.find_category(EAST, -2.5, 0.5) == 0  # by no more than k_z
    assert network.find_category(EAST, -2.51, 0.5) == -1
    assert network.find_category(-EAST, -1.0, 0.5) == -1
    network.value[0] = -9.0  # what it is worth now does not count
    assert network.find_category(EAST, -2.0, 0.5) == 0
    assert Network(1).find_category(EAST, 0.0, 9.0) == -1


def test_a_new_category_copies_its_action() -> None:
    network, action = Network(1), EAST.copy()
    network.add_category(action, -1.0)
    action[:] = 7.0
    network.best_action[0] = 5.0
    assert np.array_equal(network.prototype, [EAST])


def test_growth_past_the_first_arrays_keeps_everything() -> None:
    rng = np.random.default_rng(0)
    network, count = Network(3), 300
    actions, values, places = rng.random((count, 2)), rng.random(count), rng.random((count, 3))
    for i in range(count):
        assert network.add_category(actions[i], values[i]) == i
        network.add_exemplar(places[i], i)
        network.weights[-1] = i
        network.trace[-1] = -i
    assert np.array_equal(network.prototype, actions)
    assert np.array_equal(network.best_action, actions)
    assert np.array_equal(network.value, values) and np.array_equal(network.initial_value, values)
    assert np.array_equal(network.situation, places)
    assert np.array_equal(network.category, np.arange(count))
    assert np.array_equal(network.weights, np.repeat(np.arange(count), 2).reshape(-1, 2))
    assert np.array_equal(network.trace, -np.arange(count))


def filled(size: int = 3, count: int = 140) -> Network:
    network, rng = Network(size), np.random.default_rng(1)
    for i in range(count):
        network.add_category(rng.random(2), -float(i))
        network.add_exemplar(rng.random(size), i)
    return network


def test_what_is_restored_is_the_same_grows_on_and_is_its_own() -> None:
    first, second = filled(), Network(3)
    second.restore(first.arrays())
    for name, array in first.arrays().items():
        assert np.array_equal(array, second.arrays()[name])
    second.add_exemplar(np.ones(3), second.add_category(EAST, 0.0))
    second.value[0] = 9.0
    assert len(first.value) == 140 and len(second.value) == 141 and first.value[0] == 0.0
    assert second.category[-1] == 140


Spoil = Callable[[Any], Any]
SPOILT: list[tuple[str, Spoil, str]] = [
    ("value", lambda a: a[:-1], "'prototype' has shape"),
    ("weights", lambda a: a[:, :1], "'weights' has shape"),
    ("situation", lambda a: a[:, :2], "'situation' has shape"),
    ("trace", lambda a: a.astype(np.float32), "type float32"),
    ("category", lambda a: a.astype(float), "type float64"),
    ("category", lambda a: a + 1, "belongs to no category"),
    ("category", lambda a: a - 1, "belongs to no category"),
    ("best_action", lambda a: a * np.nan, "not finite"),
    ("value", lambda a: a - np.inf, "not finite"),
]


@pytest.mark.parametrize(("name", "spoil", "told"), SPOILT)
def test_what_cannot_be_restored_changes_nothing(name: str, spoil: Spoil, told: str) -> None:
    network, arrays = filled(count=5), filled().arrays()
    before = network.arrays()
    with np.errstate(invalid="ignore"):
        arrays[name] = spoil(arrays[name])
    with pytest.raises(ValueError, match=told):
        network.restore(arrays)
    del arrays[name]
    with pytest.raises(ValueError, match=f"lacks the array '{name}'"):
        network.restore(arrays)
    assert all(np.array_equal(network.arrays()[key], before[key]) for key in before)
