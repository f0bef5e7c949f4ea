"""The network in numpy: what it accepts, and that it is Stable-Baselines3's, to rounding."""

from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces
from nomad_agents.deep import LEARNERS, Policy
from nomad_agents.deep.policy import policy_from

W, V = np.ones((3, 2), np.float32), np.ones((1, 3), np.float32)
B, C = np.zeros(3, np.float32), np.zeros(1, np.float32)


class Nowhere(gymnasium.Env[Any, Any]):
    """Something with the spaces of path finding."""

    observation_space = spaces.Box(0.0, 1.0, (26,), np.float32)
    action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)


@pytest.mark.parametrize("name", LEARNERS)
def test_actions_are_those_that_the_learner_predicts(name: str) -> None:
    torch = pytest.importorskip("torch")
    learner = pytest.importorskip("nomad_agents.deep.learner")
    model = learner.make_model(replace(LEARNERS[name](), hidden=(32, 16)), Nowhere(), 0)
    rng = np.random.default_rng(0)
    for parameter in model.policy.parameters():  # large ones: many actions reach the bound
        values = rng.normal(0, 0.7, tuple(parameter.shape)).astype(np.float32)
        parameter.data.copy_(torch.from_numpy(values))
    policy = learner.policy_of(model)
    shown = rng.random((500, 26), np.float32)
    actions = policy(shown)
    assert actions.dtype == np.float32 and 0.1 < (np.abs(actions) > 0.99).mean() < 0.9
    assert actions == pytest.approx(model.predict(shown, deterministic=True)[0], abs=1e-5)
    assert policy(shown[7]) == pytest.approx(actions[7], abs=1e-5)
    before = policy(shown).copy()
    for parameter in model.policy.parameters():
        parameter.data.zero_()
    assert np.array_equal(policy(shown), before), "a policy is a copy: learning does not change it"


def test_a_network_by_hand() -> None:
    policy = Policy((W, V), (B - 1, C), "relu", "clip")
    # Each of three units has 0.5 + 0.7 - 1 = 0.2.
    assert policy(np.array([0.5, 0.7], np.float32)) == pytest.approx([0.6])
    assert policy(np.array([[0.5, 0.0], [9.0, 9.0]], np.float32)).tolist() == [[0.0], [1.0]]
    squashed = Policy((W, V), (B, C), "tanh", "tanh")
    expected = np.tanh(3 * np.tanh(0.2))
    assert squashed(np.array([0.1, 0.1], np.float32)) == pytest.approx([expected])
    assert (policy.inputs, policy.outputs) == (2, 1)


def test_a_policy_comes_back_from_its_arrays() -> None:
    policy = Policy((W * 0.3, V), (B, C + 0.1), "tanh", "clip")
    again = policy_from(policy.arrays(), "tanh", "clip")
    shown = np.random.default_rng(0).random((9, 2), np.float32)
    assert np.array_equal(policy(shown), again(shown))
    with pytest.raises(ValueError, match="not the layers of a network"):
        policy_from({"weight_0": W, "bias_1": B}, "tanh", "clip")


@pytest.mark.parametrize(
    ("weights", "biases", "told"),
    [
        ((), (), "0 layers"),
        ((W, V), (B,), "2 layers of weights, 1 of biases"),
        ((W, W), (B, B), "after"),
        ((W, V), (C, C), "after"),
        ((B, V), (B, C), "after"),
        ((W.astype(np.float64), V), (B, C), "float64"),
        ((W * np.float32(np.nan), V), (B, C), "not finite"),
    ],
)
def test_what_is_no_network_is_refused(weights: Any, biases: Any, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        Policy(weights, biases, "relu", "tanh")
