"""The classical agents: laws that hold on any map, and an episode of each robot's."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from nomad_agents.agent import Agent
from nomad_agents.baselines import (
    DwaConfig,
    DynamicWindow,
    PotentialConfig,
    PotentialField,
    RandomMoves,
    VectorFieldHistogram,
    VfhConfig,
)
from nomad_agents.baselines.classical import BLOCKED
from nomad_agents.baselines.way import action_towards, free_way, occupied_cells, reach_of
from nomad_agents.episode import run_episode
from nomad_agents.reactive_planner import FAITHFUL
from nomad_agents.registry import make_agent

import nomad_mj
from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError
from nomad_mj.geometry import direction
from nomad_mj.motion import ActionSpec, displacement
from nomad_mj.perception import GridSpec, Percept, cell_centres
from nomad_mj.types import FloatArray, RangeRing, SensorLayout

GRID, ACTION = GridSpec(), ActionSpec()
LAYOUT = SensorLayout(
    0.265, (RangeRing("sonar", tuple(np.arange(16) * np.pi / 8), np.pi / 12, 0.0, 6.5),)
)
CENTRES: FloatArray = cell_centres(GRID)
OUTSIDE = np.hypot(CENTRES[..., 0], CENTRES[..., 1]) > LAYOUT.radius
MAKERS: dict[str, Callable[[], Agent]] = {
    "vfh": lambda: VectorFieldHistogram(LAYOUT, FAITHFUL),
    "potential": lambda: PotentialField(LAYOUT, FAITHFUL),
    "dwa": lambda: DynamicWindow(LAYOUT, FAITHFUL),
}
RIVALS = list(MAKERS)
SEEDS = st.integers(0, 2**32)


def world(seed: int, density: float = 0.05) -> Percept:
    """Return a percept of cells occupied at random around the robot, and a goal."""
    rng = np.random.default_rng(seed)
    taken = rng.random((21, 21)) < density
    grid = np.where(taken, rng.uniform(0.3, 1.0, (21, 21)), 0.0) * OUTSIDE
    return Percept(np.zeros(26), grid, rng.uniform(-5, 5, 2))


def mirrored(percept: Percept) -> Percept:
    """Return what is perceived in the world's image in the x axis."""
    return percept._replace(grid=percept.grid[::-1].copy(), goal=percept.goal * [1, -1])


def move_of(agent: Agent, percept: Percept) -> FloatArray:
    return displacement(agent.act(percept, None).action, percept.goal, ACTION)


def literal_room(move: FloatArray, cells: FloatArray, reach: float) -> float:
    """Return the room left on a move, finely divided: of `reach` about each cell, or of nine
    tenths of the distance to one that is nearer at first. Where it passes a cell most closely is
    among the places."""
    closest = np.clip(cells @ move / max(float(move @ move), 1e-12), 0, 1)
    way = np.concatenate([np.linspace(0, 1, 200), closest])[:, None] * move
    gaps = np.linalg.norm(cells[:, None] - way, axis=-1)
    distance = np.hypot(*cells.T)
    allowed = np.where(distance < reach, 0.9 * distance, reach)
    return float((gaps - allowed[:, None]).min(initial=np.inf))


@given(SEEDS, st.floats(-7, 7), st.floats(0.01, 1.0))
def test_the_action_of_a_move_is_the_inverse_of_the_move(
    seed: int, heading: float, length: float
) -> None:
    goal = np.random.default_rng(seed).uniform(-5, 5, 2)
    length = min(length, float(np.hypot(*goal)))
    move = displacement(action_towards(heading, length, goal, ACTION), goal, ACTION)
    assert move == pytest.approx(length * np.array([math.cos(heading), math.sin(heading)]))


@given(SEEDS, st.floats(0.3, 0.6), st.floats(0.0, 0.1))
def test_a_free_way_ends_where_the_disc_touches(seed: int, reach: float, density: float) -> None:
    rng = np.random.default_rng(seed)
    cells = occupied_cells(world(seed, density), GRID, 0.5)
    assume((abs(np.hypot(*cells.T) - reach) > 1e-9).all())
    headings = rng.uniform(-np.pi, np.pi, 4)
    for heading, free in zip(headings, free_way(headings, cells, reach), strict=True):
        ahead = np.array([math.cos(heading), math.sin(heading)])
        if not free:  # a cell that is too near already would come nearer
            assert literal_room(6 * ahead, cells[np.hypot(*cells.T) < reach], reach) <= 1e-6
        elif np.isfinite(free):
            assert literal_room(free * ahead, cells, reach) == pytest.approx(0.0, abs=0.01)
        else:
            assert literal_room(6 * ahead, cells, reach) >= -1e-6


def test_a_cell_behind_leaves_no_room_ahead() -> None:
    wall, behind = np.array([[0.6, 0.0]]), np.array([[-0.2, -0.2]])
    alone = free_way(np.zeros(1), wall, 0.465)
    assert alone == pytest.approx([0.135])
    assert free_way(np.zeros(1), np.concatenate([wall, behind]), 0.465) == alone


@pytest.mark.parametrize("name", RIVALS)
def test_none_creeps_into_what_is_too_near_already(name: str) -> None:
    """Where something is nearer than the safety distance on the way to the goal, go round it."""
    agent, start = MAKERS[name](), np.array([0.0, 0.03])
    place = start
    for _ in range(12):
        x, y = CENTRES[..., 0] + place[0], CENTRES[..., 1] + place[1]
        post = (np.hypot(x - 0.36, y) < 0.11).astype(np.float64)
        place = place + move_of(agent, Percept(np.zeros(26), post, np.array([4.0, 0.0]) - place))
        assert np.hypot(place[0] - 0.36, place[1]) > LAYOUT.radius
    assert np.hypot(*(place - [4.0, 0.0])) < 1.0


def test_what_sensors_do_not_see_is_kept_off() -> None:
    blind = SensorLayout(0.2, (RangeRing("sonar", (0.0,), 0.1, 0.15, 5.0),))
    assert reach_of(blind, 0.1) == pytest.approx(0.45)
    assert reach_of(LAYOUT, 0.1) == pytest.approx(0.365)


@pytest.mark.parametrize("name", RIVALS)
@given(seed=SEEDS)
def test_on_an_empty_map_they_go_straight_to_the_goal(name: str, seed: int) -> None:
    agent = MAKERS[name]()
    percept = world(seed, 0.0)
    along, aside = agent.act(percept, None).action.tolist()
    assert aside == pytest.approx(0.0, abs=1e-9)
    # The dynamic window slows down before a goal that is just too far for one move.
    just_out = name == "dwa" and 1 < np.hypot(*percept.goal) < 2
    assert along == pytest.approx(1.0) or (just_out and along > 0.5)


@pytest.mark.parametrize("name", RIVALS)
@settings(max_examples=60)
@given(seed=SEEDS, density=st.floats(0.02, 0.15))
@example(seed=40761, density=0.09982000000000427)  # two ways equally free
@example(seed=387, density=0.09375)  # two ways equally near, to the left and to the right
def test_mirrored_worlds_give_mirrored_moves(name: str, seed: int, density: float) -> None:
    one, other = MAKERS[name](), MAKERS[name]()
    for number in range(3):  # what they remember is mirrored too
        percept = world(seed + number, density)
        first = one.act(percept, None).action
        second = other.act(mirrored(percept), None).action
        assert second == pytest.approx(first * [1, -1], abs=1e-6)


@pytest.mark.parametrize("name", RIVALS)
@settings(max_examples=60)
@given(seed=SEEDS, density=st.floats(0.0, 0.3))
def test_no_move_ends_in_what_the_map_shows_where_there_is_a_way(
    name: str, seed: int, density: float
) -> None:
    agent = MAKERS[name]()
    for number in range(3):
        percept = world(seed + number, density)
        cells = occupied_cells(percept, GRID, 0.5)
        reach = reach_of(LAYOUT, 0.15)
        every = np.linspace(-np.pi, np.pi, 36, endpoint=False) + direction(percept.goal)
        move = move_of(agent, percept)
        assert np.isfinite(move).all() and 0 < np.hypot(*move) <= 1 + 1e-9
        if (free_way(every, cells, reach) > 0.05).any():
            assert literal_room(move, cells, reach) >= -BLOCKED - 1e-3


@pytest.mark.parametrize("name", RIVALS)
def test_shut_in_they_still_decide(name: str) -> None:
    shut = Percept(np.zeros(26), OUTSIDE.astype(np.float64), np.array([3.0, 0.0]))
    for _ in range(3):
        action = MAKERS[name]().act(shut, None).action
        assert np.isfinite(action).all() and 0 < np.hypot(*action) <= 1


@pytest.mark.parametrize("name", RIVALS)
@pytest.mark.parametrize("goal", [(0.0, 0.0), (1e-9, 0.0)])
def test_at_the_goal_they_do_not_fail(name: str, goal: tuple[float, float]) -> None:
    percept = world(3)._replace(goal=np.array(goal))
    assert MAKERS[name]().act(percept, None).action.tolist() == [1.0, 0.0]


@pytest.mark.parametrize("name", RIVALS)
def test_a_wall_behind_the_goal_does_not_keep_them_from_it(name: str) -> None:
    grid = (CENTRES[..., 0] >= 1.4).astype(np.float64)
    percept = Percept(np.zeros(26), grid, np.array([0.7, 0.0]))
    assert MAKERS[name]().act(percept, None).action == pytest.approx([1.0, 0.0], abs=0.05)


def test_a_box_ahead_is_passed_on_the_shorter_side() -> None:
    x, y = CENTRES[..., 0], CENTRES[..., 1]
    box = ((abs(x - 1.2) < 0.3) & (y > -0.3) & (y < 1.1)).astype(np.float64)
    percept = Percept(np.zeros(26), box, np.array([4.0, 0.0]))
    for name in RIVALS:
        assert MAKERS[name]().act(percept, None).action[1] < 0, name


def test_along_a_wall_the_virtual_force_field_keeps_its_distance_and_gets_round() -> None:
    """Not a degree towards the wall at each move: the push of the wall must hold it off."""
    agent, goal = MAKERS["potential"](), np.array([0.3, 4.0])
    place = np.zeros(2)
    for _ in range(60):
        to_goal = goal - place
        x, y = CENTRES[..., 0] + place[0], CENTRES[..., 1] + place[1]
        wall = ((abs(x) < 2.5) & (y > 1.0) & (y < 1.4)).astype(np.float64)
        move = move_of(agent, Percept(np.zeros(26), wall, to_goal))
        place = place + move
        inside = np.clip(place, [-2.5, 1.0], [2.5, 1.4])
        assert np.hypot(*(place - inside)) > LAYOUT.radius + 0.1, place
        if np.hypot(*(goal - place)) < 0.2:
            return
    raise AssertionError(f"still at {place}")


def test_blocked_sectors_stay_blocked_between_the_thresholds() -> None:
    agent = VectorFieldHistogram(LAYOUT, FAITHFUL, VfhConfig(low=0.1, high=0.6))
    certain = Percept(np.zeros(26), np.zeros((21, 21)), np.array([4.0, 0.0]))
    certain.grid[10, 14] = 1.0  # 0.8 m ahead
    fading = certain._replace(grid=certain.grid * 0.7)
    assert agent.act(fading, None).action[1] == pytest.approx(0.0)
    agent.start_episode()
    assert abs(agent.act(certain, None).action[1]) > 0.1
    assert abs(agent.act(fading, None).action[1]) > 0.1


def test_random_moves_follow_the_stream_and_fill_the_square() -> None:
    agent = RandomMoves(LAYOUT, FAITHFUL)
    drawn: list[FloatArray] = []
    for _ in range(2):
        agent.start_episode(np.random.default_rng(7))
        drawn.append(np.array([agent.act(world(0), None).action for _ in range(4000)]))
    assert np.array_equal(drawn[0], drawn[1])
    assert drawn[0].mean(axis=0) == pytest.approx(0.0, abs=0.05)
    assert drawn[0].std(axis=0) == pytest.approx(3**-0.5, abs=0.02)
    assert not np.array_equal(drawn[0][:1], [agent.act(world(0), None).action])


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: VfhConfig(low=0.5), r"low 0.5: must be from 0 to 0.4"),
        (lambda: VfhConfig(sectors=2), r"sectors 2: must be from 8"),
        (lambda: DwaConfig(lengths=0), r"lengths 0: must be from 1"),
        (lambda: PotentialConfig(damping=2.0), r"damping 2.0: must be from 0 to 1"),
        (lambda: DwaConfig(safety=math.nan), r"safety nan"),
    ],
)
def test_settings_that_make_no_sense_are_refused(make: Callable[[], object], told: str) -> None:
    with pytest.raises(ConfigError, match=told):
        make()


@pytest.mark.parametrize("name", RIVALS)
def test_they_find_round_the_box_in_real_physics(env: PathFinding, name: str) -> None:
    agent = make_agent(name, env.scene.robot.layout, FAITHFUL)
    for start in (1, 2):
        episode = run_episode(env, agent, seed=2, start=start, max_decisions=60)
        assert episode.reached and episode.bumper_contacts == 0
        assert episode == run_episode(env, agent, seed=2, start=start, max_decisions=60)


@pytest.mark.parametrize("name", RIVALS)
@pytest.mark.parametrize("robot", ["pioneer", "khepera", "omnibot", "racer"])
def test_they_drive_every_robot(name: str, robot: str) -> None:
    with nomad_mj.load("path_finding", room="empty_room", robot=robot) as env:
        agent = make_agent(name, env.scene.robot.layout, FAITHFUL)
        assert run_episode(env, agent, seed=1, start=0, max_decisions=30).reached
