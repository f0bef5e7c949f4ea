"""What a benchmark says of many runs: profiles, curves, tables."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from known_benchmark import made_up, made_up_run
from nomad_agents.benchmark.checks import until_mastered
from nomad_agents.benchmark.efficiency import sample_efficiency
from nomad_agents.benchmark.numbers import grouped, spread_of, strata
from nomad_agents.benchmark.presentation import terminal_tables
from nomad_agents.benchmark.profiles import performance_profile
from nomad_agents.benchmark.run import barn_score_of
from nomad_agents.benchmark.tables import (
    driving_table,
    glance_table,
    learning_table,
    quartiles,
    until_cell,
)
from nomad_agents.episode import Episode
from nomad_agents.evaluation import Trial
from nomad_agents.studies.runs import Result

SCORES = st.lists(
    st.lists(st.floats(0, 1), min_size=1, max_size=5).map(np.array), min_size=1, max_size=4
)
TAUS = np.linspace(0, 1, 21)
AGENTS = ("straight", "sac:ranges", "reactive_planner:tuned")


@given(scores=SCORES)
def test_a_profile_falls_from_all_to_none_within_its_band(scores: list[np.ndarray]) -> None:
    profile = performance_profile(scores, [-1.0, *TAUS])
    assert profile.share[0] == profile.low[0] == profile.high[0] == 1
    assert profile.share[-1] == 0
    assert (np.diff(profile.share) <= 0).all()
    assert (profile.low <= profile.high + 1e-12).all()
    assert ((profile.low >= 0) & (profile.high <= 1)).all()


@given(scores=SCORES, more=st.floats(0, 0.5))
def test_who_scores_more_everywhere_has_the_higher_profile(
    scores: list[np.ndarray], more: float
) -> None:
    one = performance_profile(scores, TAUS)
    other = performance_profile([each + more for each in scores], TAUS)
    assert (other.share >= one.share).all()


@given(scores=SCORES)
def test_a_profile_does_not_know_the_order_of_runs(scores: list[np.ndarray]) -> None:
    turned = performance_profile([each[::-1] for each in scores[::-1]], TAUS)
    assert np.array_equal(performance_profile(scores, TAUS).share, turned.share)


@pytest.mark.parametrize(
    ("reached", "took", "shortest", "score"),
    [
        (True, 1.0, 2.0, 0.25),
        (True, 20.0, 2.0, 0.2),
        (True, 99.0, 2.0, 0.125),
        (False, 1.0, 2.0, 0.0),
        (True, 1.0, math.inf, 0.0),
        (True, 1.0, 0.0, 0.25),
    ],
)
def test_the_barn_score_of_an_episode(
    reached: bool, took: float, shortest: float, score: float
) -> None:
    episode = Episode(reached, 1, 1, 0, 0, 0, took, 1.0, 0.2)
    trial = Trial(np.zeros(3), episode, np.zeros((2, 2)), shortest)
    assert barn_score_of(trial, 0.5) == score


def test_mastered_is_the_first_check_with_nine_in_ten_of_each_kind() -> None:
    curve = [
        {"decisions": 0, "sim_s": 0.0, "success_rate": 0.5, "unaided_success_rate": 0.0},
        {"decisions": 25, "sim_s": 50.0, "success_rate": 0.9, "unaided_success_rate": 0.89},
        {"decisions": 50, "sim_s": 99.0, "success_rate": 0.1, "unaided_success_rate": 0.9},
    ]
    assert until_mastered(curve) == {
        "decisions_to_90": 25,
        "sim_s_to_90": 50.0,
        "unaided_decisions_to_90": 50,
        "unaided_sim_s_to_90": 99.0,
    }
    assert until_mastered(curve[:1])["decisions_to_90"] is None


def test_the_area_under_a_profile_is_the_mean() -> None:
    scores = [np.array([0.2, 0.7]), np.array([0.4])]
    profile = performance_profile(scores, np.arange(500) / 500)
    assert profile.share.mean() == pytest.approx(1.3 / 3, abs=3e-3)


def test_the_bootstrap_draws_within_tasks() -> None:
    """A run a task leaves nothing to draw: no band, however far the tasks are apart."""
    apart = performance_profile([np.array([0.1]), np.array([0.9])], TAUS)
    assert np.array_equal(apart.low, apart.high)
    together = performance_profile([np.array([0.1, 0.9])], TAUS)
    assert (together.low < together.high).any()
    with pytest.raises(ValueError, match="needs a run"):
        performance_profile([], TAUS)


def test_results_by_set_agent_and_task() -> None:
    results = made_up(("convex", "wide"), AGENTS)
    groups = grouped(results)
    assert [group.name for group in groups] == ["convex", "wide"]
    assert list(groups[0].agents) == list(AGENTS)
    assert [len(each) for each in strata(groups[0].agents["straight"], "spl")] == [3, 3]
    hours = strata(groups[0].agents["sac:ranges"], "learn_decisions")
    assert np.concatenate(hours).tolist() == [900.0] * 6
    per_episode = strata(groups[0].agents["straight"], "virtual_collisions_per_episode")
    assert per_episode[0][0] == 4 / 25


def test_several_robots_are_told_apart() -> None:
    two = made_up(("convex",), ("straight",))
    other = [Result(made_up_run("convex", "0", "straight", 0, robot="pioneer"), two[0].row)]
    assert [group.name for group in grouped([*two, *other])] == [
        "convex, nomad200",
        "convex, pioneer",
    ]


def test_tables() -> None:
    groups = grouped(made_up(("convex", "wide"), AGENTS))
    glance = glance_table(groups, "spl")
    assert glance.headings == ("", "convex", "wide", "all runs")
    assert [row[0] for row in glance.rows] == list(AGENTS)
    over = spread_of(groups[0].agents["straight"], "spl")
    assert glance.rows[0][1] == f"{over.iqm:.2f} ({over.low:.2f}, {over.high:.2f})"
    assert [row[0] for row in driving_table(groups[0]).rows] == list(AGENTS)
    learning = learning_table(groups[0])
    assert learning is not None
    assert [row[0] for row in learning.rows] == list(AGENTS[1:])
    solved = learning.headings.index("runs that solve every start")
    assert [row[solved] for row in learning.rows] == ["6 of 6", "6 of 6"]
    assert learning_table(grouped(made_up(("convex",), ("straight",)))[0]) is None


def test_a_terminal_is_shown_one_set_in_a_few_columns_and_several_at_a_glance() -> None:
    (table,) = terminal_tables(grouped(made_up(("convex",), AGENTS)))
    assert table.title == "convex" and [row[0] for row in table.rows] == list(AGENTS)
    assert table.headings == ("", "goal reached", "SPL", "decisions until 90 %")
    assert table.rows[0][3] == "" and table.rows[2][3] == "400"
    several = terminal_tables(grouped(made_up(("convex", "wide"), AGENTS)))
    assert [table.headings[1:] for table in several] == [("convex", "wide", "all runs")] * 2


def test_a_number_that_no_run_ever_reaches_is_called_never() -> None:
    results = made_up(("convex",), ("ppo",))
    for result in results:
        result.row["decisions_to_90"] = None
    table = learning_table(grouped(results)[0])
    assert table is not None
    assert table.rows[0][table.headings.index("decisions until 90 %")] == "never"
    results[0].row["decisions_to_90"] = 300
    table = learning_table(grouped(results)[0])
    assert table is not None
    assert (
        table.rows[0][table.headings.index("decisions until 90 %")]
        == "never, 1 of 6 runs get there"
    )


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ([2800, 4000, 6000, np.nan, np.nan], "6000 [4000, never], 3 of 5 runs get there"),
        ([300, 320, np.nan], "320 [310, never], 2 of 3 runs get there"),
        ([100, 200, 300, 400], "250 [175, 325]"),
        ([7, 7], "7"),
        ([np.nan], "never"),
    ],
)
def test_a_run_that_never_got_there_is_endless_in_median_and_quartiles(
    values: list[float], text: str
) -> None:
    assert until_cell(np.array(values), 0) == text


@given(st.lists(st.floats(0, 1e6), min_size=1, max_size=9))
def test_quartiles_are_numpys_where_all_are_finite(values: list[float]) -> None:
    expected = np.percentile(values, [25, 50, 75])
    # Between neighbours below the normal numbers either is the middle.
    tiny = np.finfo(float).tiny
    np.testing.assert_allclose(quartiles(np.array(values)), expected, rtol=1e-12, atol=tiny)


def curve(*points: tuple[int, float], seed: int = 0) -> Result:
    entries = [{"decisions": n, "success_rate": rate} for n, rate in points]
    return Result(made_up_run("convex", "0", "sac", seed), {}, curve=entries)


def test_sample_efficiency_is_of_all_runs_and_marks_the_median_of_90_percent() -> None:
    runs = [
        curve((0, 0.0), (100, 0.9), (200, 1.0)),
        curve((0, 0.0), (100, 0.5), (300, 0.95)),
        curve((0, 0.0), (400, 0.2)),
    ]
    found = sample_efficiency(runs)
    assert found is not None
    assert found.decisions.tolist() == [0, 100, 200, 300, 400]
    assert found.median.tolist() == [0.0, 0.5, pytest.approx(0.725), 0.95, 0.95]
    assert (found.low <= found.median).all() and (found.median <= found.high).all()
    assert found.mastered == 300
    assert sample_efficiency(runs[2:]).mastered == np.inf  # type: ignore[union-attr]
    assert sample_efficiency(runs, "unaided_") is None
