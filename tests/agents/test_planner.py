"""The planner: Eqs 19-20 against plain loops, barred moves, symmetry."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import See
from hypothesis import assume, given
from hypothesis import strategies as st
from nomad_agents.reactive_planner import ACTIONS, FAITHFUL, PlannerConfig, estimate_value, plan
from nomad_agents.reactive_planner.planner import path_clearance

from nomad_mj.motion import ActionSpec, displacement, reinforcement
from nomad_mj.perception import GridSpec, Percept, cell_centres
from nomad_mj.types import FloatArray

GRID, ACTION, RADIUS = GridSpec(), ActionSpec(), 0.265
CONFIG = FAITHFUL.planner
CENTRES: FloatArray = cell_centres(GRID)
OUTSIDE = np.hypot(CENTRES[..., 0], CENTRES[..., 1]) > RADIUS


def world(seed: int, density: float = 0.1) -> Percept:
    """Return a percept of cells occupied at random around the robot, and a goal."""
    rng = np.random.default_rng(seed)
    grid = np.where(rng.random((21, 21)) < density, rng.random((21, 21)), 0.0) * OUTSIDE
    return Percept(np.zeros(26), grid, rng.uniform(-5, 5, 2))


def wall(x: float, y: float = 0.0, half: float = 9.0) -> Percept:
    """Return a percept of cells occupied from `x` on, `half` to either side of y; goal east."""
    ahead = (CENTRES[..., 0] >= x) & (np.abs(CENTRES[..., 1] - y) <= half)
    return Percept(np.zeros(26), ahead.astype(np.float64), np.array([4.0, 0.0]))


def literal_estimate(place: FloatArray, percept: Percept, config: PlannerConfig) -> float:
    """Return Eqs 19-20, cell by cell."""
    goal = percept.goal - place
    total = 0.0
    for row in range(21):
        for column in range(21):
            x, y = (CENTRES[row, column] - place).tolist()
            turn = abs(math.remainder(math.atan2(y, x) - math.atan2(goal[1], goal[0]), math.tau))
            if turn <= config.k_alpha:
                total += percept.grid[row, column] / max(math.hypot(x, y), config.k_clear)
    return -config.k_length * math.hypot(*goal) - config.k_rep * total


def literal_clearance(move: FloatArray, percept: Percept, config: PlannerConfig) -> float:
    """Return how near a disc comes to occupied cells, along a finely divided move."""
    way = np.linspace(0, 1, 400)[:, None] * move
    cells = CENTRES[percept.grid > config.occupied]
    off = np.linalg.norm(cells[:, None] - way, axis=-1)
    return float(off.min(initial=np.inf)) - RADIUS - config.margin


def test_the_actions_are_those_of_the_paper_but_the_null_action() -> None:
    assert ACTIONS.shape == (80, 2) and len(np.unique(ACTIONS, axis=0)) == 80
    assert ACTIONS.any(axis=1).all()
    assert np.unique(ACTIONS).tolist() == [-1, -0.75, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1]
    with pytest.raises(ValueError, match="read-only"):
        ACTIONS[0] = 0.0


@given(st.integers(0, 2**32), st.floats(0.0, 0.5))
def test_the_estimate_is_that_of_the_equations(seed: int, density: float) -> None:
    percept = world(seed, density)
    config = replace(CONFIG, k_alpha=0.7)  # no cell lies on the edge of so odd an angle
    places = np.random.default_rng(seed).uniform(-1, 1, (3, 2))
    literal = [literal_estimate(place, percept, config) for place in places]
    assert estimate_value(places, percept, GRID, config) == pytest.approx(literal)


def test_a_free_place_is_worth_its_distance() -> None:
    percept = Percept(np.zeros(26), np.zeros((21, 21)), np.array([3.0, 4.0]))
    value = estimate_value(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]]), percept, GRID, CONFIG)
    assert value == pytest.approx([-3.75, -3.0, 0.0])


@given(st.floats(0.0, 0.9), st.floats(0.0, 0.9), st.floats(-0.2, 0.2))
def test_the_nearer_to_a_thing_ahead_the_more_it_repels(
    one: float, other: float, aside: float
) -> None:
    places = np.array([[min(one, other), aside], [max(one, other), aside]])
    thing = wall(1.3, half=0.15)._replace(goal=np.array([99.0, aside]))
    thing.grid[CENTRES[..., 0] > 1.5] = 0.0
    free = thing._replace(grid=np.zeros((21, 21)))
    cost = estimate_value(places, free, GRID, CONFIG) - estimate_value(places, thing, GRID, CONFIG)
    assert 0 < cost[0] <= cost[1]


@given(st.integers(0, 2**32))
def test_the_goal_itself_is_worth_nothing_whatever_stands_around(seed: int) -> None:
    percept = world(seed, 0.5)
    near = percept._replace(goal=percept.goal / 9)
    moves = displacement(np.array([[1.0, 0.0]]), near.goal, ACTION)  # right to it, but for rounding
    assert estimate_value(moves, near, GRID, CONFIG) == pytest.approx([0.0], abs=1e-9)


def test_what_lies_behind_does_not_repel() -> None:
    behind = wall(1.2)._replace(goal=np.array([-4.0, 0.0]))
    assert estimate_value(np.zeros((1, 2)), behind, GRID, CONFIG) == pytest.approx([-3.0])


@given(st.integers(0, 2**32))
def test_the_clearance_of_moves_is_that_of_a_disc_along_them(seed: int) -> None:
    percept = world(seed)
    moves = np.random.default_rng(seed).uniform(-1, 1, (4, 2))
    clearance, now = path_clearance(moves, percept, RADIUS, GRID, CONFIG)
    literal = [literal_clearance(move, percept, CONFIG) for move in moves]
    assert clearance == pytest.approx(literal, abs=0.01)
    assert now == pytest.approx(literal_clearance(np.zeros(2), percept, CONFIG))


def test_nothing_seen_is_infinitely_far() -> None:
    clearance, now = path_clearance(ACTIONS, world(0, 0.0), RADIUS, GRID, CONFIG)
    assert np.isinf(clearance).all() and now == math.inf


@given(st.integers(0, 2**32), st.floats(0.0, 0.2))
def test_the_plan_is_the_best_that_is_not_barred(seed: int, density: float) -> None:
    percept = world(seed, density)
    best = plan(percept, RADIUS, GRID, ACTION, CONFIG)
    moves = displacement(ACTIONS, percept.goal, ACTION)
    clearance, now = path_clearance(moves, percept, RADIUS, GRID, CONFIG)
    value = reinforcement(moves, percept.goal, np.maximum(clearance, 0.0))
    value = value + estimate_value(moves, percept, GRID, CONFIG)
    free = [n for n in range(len(ACTIONS)) if clearance[n] > 0 or clearance[n] >= now - 1e-9]
    chosen = int(np.flatnonzero((best.action == ACTIONS).all(axis=1))[0])
    assert best.value == value[chosen]
    if free:
        assert chosen in free and best.value == max(value[n] for n in free)
    else:
        assert clearance[chosen] == clearance.max()


def test_in_the_open_the_plan_leads_straight_to_the_goal(see: See) -> None:
    best = plan(see((0.0, 3.0)), RADIUS, GRID, ACTION, CONFIG)
    assert best.action.tolist() == [1.0, 0.0]
    assert best.value == pytest.approx(-0.75 * 2.0)


def test_a_plan_does_not_drive_into_a_wall_nor_a_box() -> None:
    for percept in (wall(1.0), wall(0.8, y=0.2, half=0.5)):
        best = plan(percept, RADIUS, GRID, ACTION, CONFIG)
        move = displacement(best.action, percept.goal, ACTION)
        assert literal_clearance(move, percept, CONFIG) > 0


def test_boxed_in_the_plan_keeps_as_far_off_as_it_can() -> None:
    boxed = Percept(np.zeros(26), OUTSIDE.astype(np.float64), np.array([3.0, 0.0]))
    best = plan(boxed, RADIUS, GRID, ACTION, CONFIG)
    assert np.isfinite(best.value) and 0 < np.abs(best.action).max() <= 1


def leaves_a_choice(percept: Percept) -> bool:
    """Return False where every move is barred: the farthest off is then often a tie."""
    moves = displacement(ACTIONS, percept.goal, ACTION)
    return bool((path_clearance(moves, percept, RADIUS, GRID, CONFIG)[0] > 1e-6).any())


def mirrored(percept: Percept) -> Percept:
    """Return what is perceived in the world's image in the x axis."""
    return percept._replace(grid=percept.grid[::-1], goal=percept.goal * [1, -1])


@given(st.integers(0, 2**32), st.floats(0.0, 0.1))
def test_mirrored_worlds_give_mirrored_plans(seed: int, density: float) -> None:
    percept = world(seed, density)
    assume(leaves_a_choice(percept))
    one = plan(percept, RADIUS, GRID, ACTION, CONFIG)
    other = plan(mirrored(percept), RADIUS, GRID, ACTION, CONFIG)
    assert other.value == pytest.approx(one.value)
    if density > 0.03:  # enough to break ties
        assert other.action == pytest.approx(one.action * [1, -1])


@given(st.integers(0, 2**32))
def test_turned_worlds_give_the_same_plan(seed: int) -> None:
    percept = world(seed, 0.06)
    assume(leaves_a_choice(percept))
    turned = percept._replace(
        grid=np.rot90(percept.grid, -1),  # rows run along y: this turns left
        goal=np.array([-percept.goal[1], percept.goal[0]]),
    )
    one, other = (plan(p, RADIUS, GRID, ACTION, CONFIG) for p in (percept, turned))
    assert other.value == pytest.approx(one.value)
    assert other.action == pytest.approx(one.action)
