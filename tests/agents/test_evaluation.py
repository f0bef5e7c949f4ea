"""Evaluation: laws of the metrics, files of starts, determinism."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from nomad_agents.baselines import Planner, Straight
from nomad_agents.episode import Episode
from nomad_agents.evaluation import (
    Trial,
    draw_starts,
    evaluate,
    path_efficiency,
    read_starts,
    summarise,
)
from nomad_agents.reactive_planner import FAITHFUL

from nomad_mj.envs import PathFinding, load
from nomad_mj.errors import ConfigError, StartError
from nomad_mj.types import FloatArray

KEYS = [
    *("episodes", "success_rate", "strict_success_rate", "spl", "path_ratio_median"),
    *("min_clearance_m", "virtual_collisions", "bumper_contacts", "no_match_rate", "mean_time_s"),
]
lengths = st.just(0.0) | st.floats(1e-6, 100)


@given(st.booleans(), lengths | st.just(math.inf), lengths)
def test_the_term_of_spl_is_a_share(reached: bool, shortest: float, length: float) -> None:
    term = path_efficiency(reached, shortest, length)
    assert 0 <= term <= 1
    assert reached or term == 0


@pytest.mark.parametrize(
    ("reached", "shortest", "length", "term"),
    [
        (True, 2.0, 4.0, 0.5),
        (True, 4.0, 2.0, 1.0),
        (False, 2.0, 2.0, 0.0),
        (True, 0.0, 0.0, 1.0),
        (True, 0.0, 1.0, 0.0),
        (True, math.inf, 1.0, 0.0),
    ],
)
def test_the_term_of_spl(reached: bool, shortest: float, length: float, term: float) -> None:
    assert path_efficiency(reached, shortest, length) == term


def trial(
    reached: bool = True,
    shortest: float = 2.0,
    virtual: int = 0,
    bumps: int = 0,
    unmatched: int = 0,
    track: FloatArray | None = None,
) -> Trial:
    """Return a trial of 3 m and 12 s through the small room's free south."""
    way = np.array([[-4.0, -3.0], [-1.0, -3.0]]) if track is None else track
    episode = Episode(reached, 5, 4, unmatched, virtual, bumps, 12.0, 3.0, 0.2)
    return Trial(np.array([*way[0], 0.0]), episode, way, shortest)


def test_the_metrics_of_known_trials(env: PathFinding) -> None:
    trials = [trial(), trial(virtual=2, shortest=3.0), trial(bumps=1), trial(False, unmatched=3)]
    summary = summarise(env, trials)
    assert list(summary) == KEYS
    assert summary == {
        "episodes": 4,
        "success_rate": 0.75,
        "strict_success_rate": 0.25,
        "spl": pytest.approx((2 / 3 + 1 + 2 / 3) / 4),
        "path_ratio_median": pytest.approx(1.5),
        "min_clearance_m": pytest.approx(1.0 - env.scene.robot.layout.radius),  # west wall
        "virtual_collisions": 2,
        "bumper_contacts": 1,
        "no_match_rate": 0.25,
        "mean_time_s": 12.0,
    }


def test_metrics_of_nothing_are_not_numbers(env: PathFinding) -> None:
    summary = summarise(env, [])
    assert list(summary) == KEYS and summary["episodes"] == 0
    assert math.isnan(summary["success_rate"]) and math.isnan(summary["min_clearance_m"])
    failed = summarise(env, [trial(False)])
    assert failed["success_rate"] == failed["spl"] == 0.0
    assert math.isnan(failed["path_ratio_median"]) and math.isnan(failed["mean_time_s"])


trials_ = st.lists(
    st.builds(
        trial,
        st.booleans(),
        lengths | st.just(math.inf),
        st.integers(0, 3),
        st.integers(0, 1),
        st.integers(0, 2),
    ),
    min_size=1,
    max_size=6,
)


@given(trials=trials_)
def test_laws_of_the_metrics(env: PathFinding, trials: list[Trial]) -> None:
    s = summarise(env, trials)
    assert 0 <= s["spl"] <= s["success_rate"] <= 1
    assert 0 <= s["strict_success_rate"] <= s["success_rate"]
    assert 0 <= s["no_match_rate"] <= 1 and s["episodes"] == len(trials)


def test_real_episodes_keep_the_laws_and_repeat(env: PathFinding) -> None:
    starts = draw_starts(env, 4, 3)
    for agent in (
        Planner(env.scene.robot.layout, FAITHFUL),
        Straight(env.scene.robot.layout, FAITHFUL),
    ):
        seen: list[Trial] = []
        trials = evaluate(env, agent, starts, 3, 40, seen.append)
        assert seen == trials and len(trials) == 4
        for each, start in zip(trials, starts, strict=True):
            assert each.start == pytest.approx(start)
            assert each.track[0] == pytest.approx(start[:2])
            assert each.shortest >= math.dist(start[:2], env.scene.arena.goal) - 1e-9
            if each.episode.reached:
                assert each.length >= each.shortest - 0.35  # it need not reach the goal's middle
                assert math.dist(each.track[-1], env.scene.arena.goal) < 0.35
        again = evaluate(env, agent, starts[::-1][::-1], 3, 40)
        assert [t.episode for t in again] == [t.episode for t in trials]
        assert all(np.array_equal(a.track, b.track) for a, b in zip(again, trials, strict=True))
        other = evaluate(env, agent, starts[:1], 4, 40)[0]
        assert other.episode.clearance != trials[0].episode.clearance  # other noise


def test_who_looks_on_still_does(env: PathFinding) -> None:
    agent, seen = Straight(env.scene.robot.layout, FAITHFUL), list[int]()

    def look_on() -> None:
        seen.append(1)

    env.on_control_step = look_on
    try:
        (trial,) = evaluate(env, agent, draw_starts(env, 1, 3), 0, 1)
        assert len(seen) == len(trial.track) - 1 > 0
        assert env.on_control_step is look_on
    finally:
        env.on_control_step = None


def test_starts_are_drawn_where_the_robot_fits(env: PathFinding) -> None:
    starts, goal = draw_starts(env, 300, 5), env.scene.arena.goal
    assert starts.shape == (300, 3) and np.array_equal(starts, draw_starts(env, 300, 5))
    assert not np.array_equal(starts, draw_starts(env, 300, 6))
    assert (env.scene.plan.clearance(starts[:, :2], env.scene.robot.layout.radius) > 0.12).all()
    assert (np.linalg.norm(starts[:, :2] - goal, axis=1) >= 1.2).all()
    assert np.abs(starts[:, 2]).max() <= np.pi


@pytest.mark.parametrize(("count", "seed"), [(0, 0), (-3, 0), (5, -1)])
def test_senseless_numbers_of_starts(env: PathFinding, count: int, seed: int) -> None:
    with pytest.raises(ConfigError, match=f"^starts {count}, seed {seed}: must be"):
        draw_starts(env, count, seed)


def test_more_starts_than_the_room_has(env: PathFinding) -> None:
    with pytest.raises(StartError, match=r"^found \d+ of 1000000000 places"):
        draw_starts(env, 10**9, 0)


@pytest.mark.parametrize(("seed", "decisions"), [(-1, 5), (0, 0), (0, -1)])
def test_senseless_evaluations(env: PathFinding, seed: int, decisions: int) -> None:
    agent = Straight(env.scene.robot.layout, FAITHFUL)
    with pytest.raises(ConfigError, match=f"seed {seed}, max_decisions {decisions}: must be"):
        evaluate(env, agent, np.array([[0.0, -1.0, 0.0]]), seed, decisions)


def test_a_start_in_an_obstacle_is_refused_before_anything_runs(env: PathFinding) -> None:
    agent = Straight(env.scene.robot.layout, FAITHFUL)
    ran: list[Trial] = []
    with pytest.raises(StartError, match=r"inside 'obstacle_1'"):
        evaluate(env, agent, np.array([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]]), 0, 5, ran.append)
    assert not ran


def test_files_of_starts(tmp_path: Path) -> None:
    path = tmp_path / "starts.csv"
    path.write_text("# x, y [m], heading [rad]\n1,2\n\n  3.5 , -4e0, 1.5  # here\r\n#end\n")
    assert read_starts(path).tolist() == [[1.0, 2.0, 0.0], [3.5, -4.0, 1.5]]
    path.write_bytes(b"\xef\xbb\xbf1,2")  # as spreadsheets begin a file
    assert read_starts(path).tolist() == [[1.0, 2.0, 0.0]]


@pytest.mark.parametrize(
    "line", ["x,y", "1", "1,2,3,4", "1;2", "1,nan", "inf,2", "1,,2", "1,2,", "a" * 500]
)
def test_a_malformed_line_is_named_with_its_number(tmp_path: Path, line: str) -> None:
    path = tmp_path / "starts.csv"
    path.write_text(f"# comment\n1,2\n{line}\n")
    with pytest.raises(StartError, match=r"line 3: '.*' is not x,y or x,y,heading$") as caught:
        read_starts(path)
    assert len(str(caught.value)) < len(str(path)) + 120 and "\n" not in str(caught.value)


def test_headings_are_in_radians(tmp_path: Path) -> None:
    path = tmp_path / "starts.csv"
    path.write_text("1,2,1.57\n8,2.5,90\n")
    with pytest.raises(StartError, match=r"line 2: heading 90 is no angle in radians$"):
        read_starts(path)


def test_files_that_hold_no_starts(tmp_path: Path) -> None:
    path = tmp_path / "starts.csv"
    with pytest.raises(StartError, match=r"cannot be read: No such file or directory$"):
        read_starts(path)
    with pytest.raises(StartError, match=r"cannot be read: Is a directory$"):
        read_starts(tmp_path)
    with pytest.raises(StartError, match="home directory"):
        read_starts(Path("~nobody-there/starts.csv"))
    path.write_bytes(bytes(range(256)))
    with pytest.raises(StartError, match=r"is not text$"):
        read_starts(path)
    for text in ("", "# nothing\n\n"):
        path.write_text(text)
        with pytest.raises(StartError, match=r"holds no start; lines are x,y\[,heading\]$"):
            read_starts(path)


def test_what_moves_is_evaluated_to_the_goals_first_place() -> None:
    """Also in a room of whose goal and obstacles nothing stands still."""
    with load(room="moving_room") as env:
        starts = draw_starts(env, 3, 1)
        trials = evaluate(env, Straight(env.scene.robot.layout, FAITHFUL), starts, 1, 20)
        for trial in trials:
            assert trial.shortest >= math.dist(trial.start[:2], env.scene.arena.goal) - 1e-9
        told = summarise(env, trials)
        assert 0 <= told["spl"] <= told["success_rate"] <= 1 and told["min_clearance_m"] > 0
        again = evaluate(env, Straight(env.scene.robot.layout, FAITHFUL), starts, 1, 20)
        assert [t.episode for t in again] == [t.episode for t in trials]
