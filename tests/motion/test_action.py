import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from nomad_mj.errors import ConfigError
from nomad_mj.geometry import direction, rotate, wrap_angle
from nomad_mj.motion import SAFE_CLEARANCE, ActionSpec, displacement, reinforcement
from nomad_mj.types import FloatArray

SPEC = ActionSpec()
actions = arrays(np.float64, 2, elements=st.floats(-1, 1))
goals = arrays(np.float64, 2, elements=st.floats(-10, 10)).filter(lambda g: np.hypot(*g) > 1e-3)
turns = st.floats(-3.1, 3.1)
clearances = st.floats(0, 7)


@given(actions, goals)
def test_a_move_is_as_long_as_equations_3_to_5_say(action: FloatArray, goal: FloatArray) -> None:
    length = float(np.hypot(*displacement(action, goal, SPEC)))
    radius = min(SPEC.longest, float(np.hypot(*goal)))
    wanted = max(min(1.0, float(np.hypot(*action))) * radius, SPEC.shortest)
    assert length == pytest.approx(wanted)
    assert SPEC.shortest - 1e-12 <= length <= max(SPEC.longest, SPEC.shortest) + 1e-12


@given(actions.filter(lambda a: np.hypot(*a) > 1e-3), goals)
def test_the_angle_to_the_goal_is_the_actions_own(action: FloatArray, goal: FloatArray) -> None:
    off = direction(displacement(action, goal, SPEC)) - direction(goal) - direction(action)
    assert abs(wrap_angle(off)) < 1e-6


@given(actions, goals, turns)
def test_turning_the_goal_turns_the_move(action: FloatArray, goal: FloatArray, turn: float) -> None:
    turned = displacement(action, rotate(goal, turn), SPEC)
    np.testing.assert_allclose(turned, rotate(displacement(action, goal, SPEC), turn), atol=1e-9)


@given(actions, goals)
def test_the_other_hand_mirrors_the_move(action: FloatArray, goal: FloatArray) -> None:
    ahead = np.array([np.hypot(*goal), 0.0])
    left, right = (displacement(action * [1, hand], ahead, SPEC) for hand in (1, -1))
    np.testing.assert_allclose(left * [1, -1], right, atol=1e-12)


@given(goals)
def test_the_null_action_is_a_short_step_to_the_goal(goal: FloatArray) -> None:
    move = displacement([0, 0], goal, SPEC)
    np.testing.assert_allclose(move, goal / np.hypot(*goal) * SPEC.shortest, atol=1e-12)


@given(goals)
def test_a_full_step_never_passes_the_goal(goal: FloatArray) -> None:
    move = displacement([1, 0], goal, SPEC)
    distance = float(np.hypot(*goal))
    left = distance - min(max(distance, SPEC.shortest), SPEC.longest)
    if distance <= SPEC.longest:
        left = min(distance - SPEC.shortest, 0.0)
    assert np.hypot(*(goal - move)) == pytest.approx(abs(left), abs=1e-9)


@given(actions, goals, clearances, st.booleans())
def test_z_lies_between_the_worst_and_nothing(
    action: FloatArray, goal: FloatArray, clearance: float, collided: bool
) -> None:
    z = reinforcement(displacement(action, goal, SPEC), goal, clearance, collided)
    assert -1 <= z <= 0
    if collided:
        assert z <= -0.5


@given(st.floats(0.05, 1), goals, st.floats(SAFE_CLEARANCE, 7), st.floats(0, 0.999))
def test_only_the_way_straight_to_the_goal_with_room_costs_nothing(
    size: float, goal: FloatArray, clearance: float, near: float
) -> None:
    move = displacement([size, 0], goal, SPEC)
    assert reinforcement(move, goal, clearance) == pytest.approx(0, abs=1e-9)
    cost = reinforcement(move, goal, near * SAFE_CLEARANCE)
    assert cost == pytest.approx((near - 1) / 2, abs=1e-9)
    assert reinforcement(move, goal, clearance, True) == pytest.approx(-0.5, abs=1e-9)


@given(actions, goals, turns, clearances, st.booleans())
def test_z_does_not_depend_on_where_the_goal_lies(
    action: FloatArray, goal: FloatArray, turn: float, clearance: float, collided: bool
) -> None:
    move = displacement(action, goal, SPEC)
    here = reinforcement(move, goal, clearance, collided)
    there = reinforcement(rotate(move, turn), rotate(goal, turn), clearance, collided)
    assert there == pytest.approx(here, abs=1e-9)


@given(st.floats(0.05, 1), turns, turns, clearances)
def test_a_wider_detour_costs_more(size: float, one: float, other: float, clearance: float) -> None:
    goal = np.array([5.0, 0.0])
    straight, wide = sorted((abs(one), abs(other)))
    cost = [reinforcement(rotate([size, 0], angle), goal, clearance) for angle in (straight, wide)]
    assert cost[1] <= cost[0] + 1e-12
    assert cost[0] - cost[1] == pytest.approx(size * (wide - straight) / np.pi / 2, abs=1e-9)


@given(
    arrays(np.float64, (3, 4, 2), elements=st.floats(-1, 1)),
    arrays(np.float64, (3, 4, 2), elements=st.floats(-9, 9)),
    arrays(np.float64, (3, 4), elements=clearances),
    arrays(np.bool_, (3, 4)),
)
def test_a_stack_is_handled_as_its_parts(
    action: FloatArray, goal: FloatArray, clearance: FloatArray, collided: FloatArray
) -> None:
    move = displacement(action, goal, SPEC)
    z = reinforcement(move, goal, clearance, collided)
    for i in np.ndindex(3, 4):
        alone = displacement(action[i], goal[i], SPEC)
        np.testing.assert_allclose(move[i], alone, atol=1e-12)
        cost = reinforcement(move[i], goal[i], clearance[i], collided[i])
        np.testing.assert_allclose(z[i], cost, atol=1e-12)


@pytest.mark.parametrize(
    ("longest", "shortest"), [(1, 0), (1, -1), (0.1, 0.2), (np.nan, 0.01), (np.inf, 0.01)]
)
def test_lengths_that_make_no_sense_are_refused(longest: float, shortest: float) -> None:
    with pytest.raises(ConfigError, match="above 0, the shortest first"):
        ActionSpec(longest, shortest)
