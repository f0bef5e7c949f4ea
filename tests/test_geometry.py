import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from nomad_mj.geometry import direction, rotate, wrap_angle
from nomad_mj.types import FloatArray

angles = st.floats(-100, 100)
vectors = arrays(np.float64, 2, elements=st.floats(-10, 10))


def batch(*shape: int) -> st.SearchStrategy[FloatArray]:
    return arrays(np.float64, shape, elements=st.floats(-10, 10))


@given(angles)
def test_a_wrapped_angle_is_the_same_direction_in_half_open_range(angle: float) -> None:
    wrapped = wrap_angle(angle)
    assert -np.pi <= wrapped < np.pi
    assert np.isclose(np.exp(1j * wrapped), np.exp(1j * angle), atol=1e-9)
    np.testing.assert_allclose(wrap_angle(wrapped), wrapped, atol=1e-12)


@given(vectors, angles, angles)
def test_turns_add_up_and_keep_lengths(vector: FloatArray, one: float, other: float) -> None:
    turned = rotate(vector, one)
    np.testing.assert_allclose(rotate(turned, other), rotate(vector, one + other), atol=1e-9)
    np.testing.assert_allclose(rotate(turned, -one), vector, atol=1e-9)
    assert np.isclose(np.hypot(*turned), np.hypot(*vector))


@given(st.floats(0.1, 10), st.floats(-3.1, 3.1), st.floats(-3.1, 3.1))
def test_a_turn_adds_to_the_heading(length: float, heading: float, turn: float) -> None:
    vector = length * np.array([np.cos(heading), np.sin(heading)])
    off = wrap_angle(direction(rotate(vector, turn)) - heading - turn)
    assert abs(off) < 1e-9


@given(batch(2, 3, 2), batch(2, 3))
def test_a_stack_is_handled_as_its_parts(vector: FloatArray, angle: FloatArray) -> None:
    turned, headings, wrapped = rotate(vector, angle), direction(vector), wrap_angle(angle)
    for i in np.ndindex(2, 3):
        np.testing.assert_allclose(turned[i], rotate(vector[i], angle[i]), atol=1e-12)
        np.testing.assert_allclose(headings[i], direction(vector[i]), atol=1e-12)
        np.testing.assert_allclose(wrapped[i], wrap_angle(angle[i]), atol=1e-12)


def test_one_turn_serves_many_vectors_and_counter_clockwise_is_positive() -> None:
    np.testing.assert_allclose(rotate([[1, 0], [0, 2]], np.pi / 2), [[0, 1], [-2, 0]], atol=1e-12)
    assert wrap_angle(np.pi) == -np.pi
