"""The standard sets: the same rooms again, every start solvable, no start in two roles."""

from contextlib import closing
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from nomad_agents.benchmark.checks import CHECK_SEED, Checks
from nomad_agents.benchmark.conditions import CONDITIONS, condition_of, find_condition
from nomad_agents.benchmark.plan import MOST_SEEDS, Plan, plan_runs
from nomad_agents.benchmark.sets import SETS, Case, find_set, room_sets, write_room
from nomad_agents.evaluation import draw_starts
from nomad_agents.learners import LEARNERS, Lesson, Untaught, find_learner, usual_agents
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.registry import SETTINGS, find_config
from nomad_agents.studies.measures import UNSEEN_SEED, unseen_starts
from nomad_agents.training import Training, TrainingConfig, stream, train

import nomad_mj
from nomad_mj.assets import list_robots
from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError, NomadError, UnknownNameError
from nomad_mj.scene import build_scene

CASES = [(each.name, case) for each in SETS.values() for case in each.cases]
OTHERS = [pair for pair in CASES if pair[0] != "convex" or int(pair[1].name) < 2]


def plan(**changed: object) -> Plan:
    usual = {
        "agents": ("straight", "reactive_planner"),
        "sets": (SETS["moving"],),
        "robots": ("nomad200",),
        "seeds": 2,
        "deep_seeds": 1,
        "starts": 3,
        "check_starts": 2,
        "budget": 100,
        "whole_curves": False,
    }
    return Plan(**{**usual, **changed})  # type: ignore[arg-type]


def test_the_sets_are_those_of_the_documentation() -> None:
    counts = {name: len(each.cases) for name, each in SETS.items()}
    assert counts == {"convex": 10, "wide": 3, "concave": 3, "moving": 3, "noisy": 3, "maze": 3}
    for each in SETS.values():
        assert len({case.name for case in each.cases}) == len(each.cases)
        assert all(case.condition in CONDITIONS for case in each.cases)


@pytest.mark.parametrize(("name", "case"), OTHERS, ids=lambda each: getattr(each, "name", each))
def test_rooms_are_the_same_again_and_solvable(name: str, case: Case, tmp_path: Path) -> None:
    rooms = [write_room(case, tmp_path / folder) for folder in ("a", "b")]
    if not isinstance(case.room, str):
        assert Path(rooms[0]).read_bytes() == Path(rooms[1]).read_bytes()
    scene = build_scene(rooms[0], "nomad200")
    radius = scene.robot.layout.radius
    starts = scene.arena.starts[:, :2]
    assert len(starts) >= 20
    assert scene.plan.reaches(starts, scene.arena.goal, radius).all()


def test_a_room_is_written_once(tmp_path: Path) -> None:
    case = SETS["wide"].cases[0]
    path = Path(write_room(case, tmp_path))
    written = path.stat().st_mtime_ns
    assert write_room(case, tmp_path) == str(path) and path.stat().st_mtime_ns == written


@pytest.mark.parametrize("name", CONDITIONS)
def test_conditions_can_be_driven_in(name: str, small_room: Path) -> None:
    with nomad_mj.load("path_finding", small_room, task_kwargs=find_condition(name)) as env:
        env.reset(seed=0)
        assert np.isfinite(float(env.step([0.5, 0.0]).reward))


def test_training_checks_and_evaluation_share_no_start_and_no_stream() -> None:
    with nomad_mj.load("path_finding") as env:
        final = unseen_starts(env, 100)
        checks = draw_starts(env, 100, CHECK_SEED)
        own = env.scene.arena.starts
    for one, other in combinations((final, checks, own), 2):
        apart = np.hypot(*(one[:, None, :2] - other[None, :, :2]).transpose(2, 0, 1))
        assert apart.min() > 0
    bases = (0, UNSEEN_SEED, CHECK_SEED)  # training, evaluation and checks add the run's seed
    assert all(abs(a - b) > MOST_SEEDS for a, b in combinations(bases, 2))
    words = {tuple(stream(base, 11, 0).generate_state(4)) for base in bases}
    assert len(words) == len(bases)


def test_learning_goes_on_to_the_same_bits_whether_it_is_checked_or_not(small_room: Path) -> None:
    def opened(**_: object) -> closing[PathFinding]:
        return closing(nomad_mj.load("path_finding", small_room))

    learner, variant = find_learner("reactive_planner:tuned")
    with opened() as env, opened() as other:
        checks = Checks(env, 1, 0, 4, whole=True)
        lesson = Lesson(variant, 3, 12, opened, {"room": small_room}, checks)
        agent, row = learner.learn(lesson)
        alone = ReactivePlanner(other.scene.robot.layout, find_config(variant))
        training = train(other, alone, TrainingConfig(3, max_decisions=12), Training())
    assert isinstance(agent, ReactivePlanner) and len(checks.curve) >= 2
    assert training.decisions == row["learn_decisions"] == checks.curve[-1]["decisions"]
    assert training.plannings == row["learn_plannings"]
    held = agent.network.arrays()
    for name, array in alone.network.arrays().items():
        assert np.array_equal(array, held[name]), name


def test_a_plan_is_every_agent_in_every_task_seed_by_seed(tmp_path: Path) -> None:
    runs = plan_runs(plan(), tmp_path)
    assert len(runs) == 2 * 3 * 2 and len({run.file_name for run in runs}) == len(runs)
    assert [run.seed for run in runs] == sorted(run.seed for run in runs)
    assert {run.condition for run in runs} == {"moving goal", "moving obstacles", "people"}
    assert {run.label for run in runs} == {"straight", "reactive_planner:faithful"}
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        f"convex_{seed}.xml" for seed in range(3)
    ]


def test_a_budget_from_which_nothing_is_learnt_is_refused_at_once(tmp_path: Path) -> None:
    small = plan(agents=("planner", "ppo"), sets=tuple(room_sets(["hall"])), budget=300)
    with pytest.raises(ConfigError, match="--budget 300, ppo: decisions 300: PPO learns nothing"):
        plan_runs(small, tmp_path)


def test_deep_learners_may_have_fewer_seeds(tmp_path: Path) -> None:
    runs = plan_runs(plan(agents=("straight", "sac"), sets=tuple(room_sets(["hall"]))), tmp_path)
    assert [(run.agent, run.seed) for run in runs] == [
        ("straight", 0),
        ("sac", 0),
        ("straight", 1),
    ]


def test_parameters_tell_what_names_stand_for(tmp_path: Path) -> None:
    runs = plan_runs(plan(), tmp_path)
    told = {(run.agent, run.condition): run.parameters() for run in runs}
    assert told["straight", "people"]["condition"]["moving_obstacles"]["pause"] == 2.0
    assert told["reactive_planner", "people"]["agent"]["k_dist"] == 1.0


@pytest.mark.parametrize("name", SETTINGS)
def test_results_of_an_agent_with_other_settings_are_stale(name: str) -> None:
    learner, variant = find_learner(name)
    usual = learner.parameters(variant)
    assert usual["own"]["safety"] == SETTINGS[name].safety
    other = Untaught(name, own=replace(SETTINGS[name], safety=0.3))
    assert other.parameters(variant) == {**usual, "own": {**usual["own"], "safety": 0.3}}


def test_rooms_of_ones_own_are_sets(small_room: Path) -> None:
    (made,) = room_sets([str(small_room)])
    assert made.name == "small" and made.cases[0].room == str(small_room)
    with pytest.raises(ConfigError, match="is called 'small' too"):
        room_sets([str(small_room), str(small_room)])
    with pytest.raises(NomadError):
        room_sets(["nowhere"])


def test_names_that_stand_for_nothing() -> None:
    with pytest.raises(UnknownNameError, match=r"unknown agent 'nobody'; there are: .*straight"):
        find_learner("nobody")
    with pytest.raises(UnknownNameError, match="unknown variant of reactive_planner 'best'"):
        find_learner("reactive_planner:best")
    with pytest.raises(UnknownNameError, match="unknown set 'flat'"):
        find_set("flat")
    with pytest.raises(UnknownNameError, match="unknown condition 'rain'"):
        find_condition("rain")
    with pytest.raises(ConfigError, match="seeds 0: must be 1 to 1000"):
        plan(seeds=0)
    with pytest.raises(ConfigError, match="starts 0: must be 1 or more"):
        plan(starts=0)
    with pytest.raises(ConfigError, match="robots: name one at least"):
        plan(robots=())


def test_every_agent_has_a_learner_and_the_usual_ones_need_no_hours() -> None:
    assert {"straight", "planner", "reactive_planner", "sac", "td3", "ppo"} <= set(LEARNERS)
    usual = usual_agents()
    assert {"reactive_planner:faithful", "reactive_planner:tuned", "planner"} <= set(usual)
    assert not {find_learner(each)[0].name for each in usual} & {"sac", "td3", "ppo"}


@pytest.mark.parametrize("robot", list_robots())
@pytest.mark.parametrize("name", CONDITIONS)
def test_conditions_suit_every_robot(name: str, robot: str, small_room: Path) -> None:
    layout = build_scene(small_room, robot).robot.layout
    rings = {ring.name for ring in layout.rings}
    options = condition_of(name, layout)
    if rings >= {"sonar", "infrared"}:
        assert options == find_condition(name)
    with closing(nomad_mj.load("motor", small_room, robot, options)) as env:
        env.reset(seed=0)
