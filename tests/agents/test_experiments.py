"""What every experiment must keep: rows that JSON holds, numbers for its table, a verdict."""

import json
import math
from pathlib import Path

import pytest
from nomad_agents.evaluation import draw_starts
from nomad_agents.experiments.experiment import (
    LEARNER,
    PLANNER,
    STRAIGHT,
    Experiment,
    Study,
    Verdict,
)
from nomad_agents.experiments.learnt import train_room, training_run
from nomad_agents.experiments.paper import (
    EXPERIMENTS,
    ablations,
    adapting,
    concave,
    moving,
    places,
    robots,
)
from nomad_agents.experiments.reproduction import count_runs, trainings
from nomad_agents.studies import measures
from nomad_agents.studies.runs import Result, Row, Run, do_runs

from nomad_mj.envs import PathFinding
from nomad_mj.types import FloatArray

STUDY = Study("tuned", "paper_room", "nomad200", 3)
each_experiment = pytest.mark.parametrize("experiment", EXPERIMENTS.values(), ids=EXPERIMENTS)


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory, small_room: Path) -> tuple[Study, Path]:
    """Return a study in the small room, and the folder of an agent that has learnt it."""
    folder = tmp_path_factory.mktemp("runs")
    study = Study("tuned", str(small_room), "nomad200", 1)
    run = Run("fig6", "", LEARNER, study.config, study.room, study.robot, 0)
    do_runs([training_run(run)], train_room, folder, 1, lambda _: None)
    return study, folder


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch, small_room: Path) -> None:
    """Let all experiments make do with the small room, and with two unseen starts."""
    monkeypatch.setattr(places, "PLACES", dict.fromkeys(places.PLACES, places.Place("", (-2, 3))))
    monkeypatch.setattr(concave, "ROOM", str(small_room))
    monkeypatch.setattr(moving, "_FILMS", 1)
    cases = {case: (robot, str(small_room)) for case, (robot, _) in robots.CASES.items()}
    monkeypatch.setattr(robots, "CASES", cases)

    def few(env: PathFinding, count: int, seed: int) -> FloatArray:
        return draw_starts(env, min(count, 2), seed)

    monkeypatch.setattr(measures, "draw_starts", few)


@each_experiment
def test_every_experiment_says_what_it_is(experiment: Experiment) -> None:
    assert experiment.title and experiment.claim.endswith(".") and experiment.source
    assert experiment.table


@each_experiment
def test_runs_are_all_different_and_have_files_of_their_own(experiment: Experiment) -> None:
    runs = experiment.runs(STUDY)
    assert len({run.file_name for run in runs}) == len(runs) == len(set(runs))
    assert {run.experiment for run in runs} == {experiment.name}
    assert {run.config for run in runs} == {"tuned"}
    assert {run.case for run in runs} >= {row.case for row in experiment.table} - {""}


def test_a_study_trains_an_agent_a_seed_once_for_all_experiments() -> None:
    experiments = list(EXPERIMENTS.values())
    assert [run.seed for run in trainings(experiments, STUDY)] == [0, 1, 2]
    total = sum(len(each.runs(STUDY)) for each in experiments)
    assert count_runs(experiments, STUDY) == total + 3


@each_experiment
def test_a_run_gives_every_number_of_the_table(
    experiment: Experiment, trained: tuple[Study, Path], small: None
) -> None:
    study, folder = trained
    run = next(run for run in experiment.runs(study) if run.agent == LEARNER)
    result = experiment.work(run, folder)
    for part in (result.row, result.episodes, result.curve, result.pictures):
        assert json.loads(json.dumps(part)) == part or any_nan(part)
    rows = [row for row in experiment.table if row.case in ("", run.case)]
    assert {row.key for row in rows} <= set(result.row)


@pytest.mark.parametrize("name", ["fig7", "fig12", "fig14"])
def test_the_same_run_gives_the_same_bits(
    name: str, trained: tuple[Study, Path], small: None
) -> None:
    study, folder = trained
    experiment = EXPERIMENTS[name]
    run = experiment.runs(study)[0]
    first, second = (json.dumps(vars_of(experiment.work(run, folder))) for _ in range(2))
    assert first == second


def test_learning_on_changes_no_agent_on_file(trained: tuple[Study, Path], small: None) -> None:
    study, folder = trained
    experiment = EXPERIMENTS["fig12"]
    off, on = (
        next(r for r in experiment.runs(study) if r.agent == LEARNER and r.case == case)
        for case in ("learning off", "learning on")
    )
    before = json.dumps(vars_of(experiment.work(off, folder)))
    learning = json.dumps(vars_of(experiment.work(on, folder)))
    assert json.dumps(vars_of(experiment.work(off, folder))) == before
    assert learning.replace("learning on", "learning off") != before


def test_a_verdict_follows_the_numbers() -> None:
    def verdict(reactions: int, reached: float) -> Verdict:
        row = {"learn_solved_all": True, "learn_reactions": reactions, "success_rate": reached}
        run = Run("fig6", "", LEARNER, "faithful", "paper_room", "nomad200", 0)
        return EXPERIMENTS["fig6"].judge([Result(run, row), other])

    other = Result(Run("fig6", "", PLANNER, "faithful", "paper_room", "nomad200", 0), {})
    assert verdict(700, 1.0).holds == "holds"
    assert verdict(700, 0.9).holds == "holds in part"
    assert verdict(2000, 1.0).holds == "holds in part"


def learner(case: str = "", **row: object) -> tuple[str, str, Row]:
    return case, LEARNER, row


def noises(*reached: float) -> list[tuple[str, str, Row]]:
    cases = ("none", "±15 %", "±30 %")
    return [learner(case, success_rate=share) for case, share in zip(cases, reached, strict=True)]


PLANNED = ("", PLANNER, {"suitable": 0.8})
OFF, ON = "learning off", "learning on"
RULES: list[tuple[str, list[tuple[str, str, Row]], str]] = [
    ("fig7", [learner(known=0.9, suitable=0.75), PLANNED], "holds"),
    ("fig7", [learner(known=0.89, suitable=0.75), PLANNED], "holds in part"),
    ("fig7", [learner(known=0.89, suitable=0.74), PLANNED], "does not hold"),
    ("fig8", [learner("2 m", alike=0.75, success_rate=0.9)], "holds"),
    ("fig8", [learner("2 m", alike=0.75, success_rate=0.89)], "holds in part"),
    ("fig8", [learner("2 m", alike=0.74, success_rate=0.74)], "does not hold"),
    ("fig9", [learner("clutter", known=0.49, known_suitable=0.2)], "holds"),
    ("fig9", [learner("clutter", known=0.5, known_suitable=0.2)], "holds in part"),
    ("fig9", [learner("clutter", known=0.5, known_suitable=0.96)], "does not hold"),
    ("fig11", [learner(OFF, success_rate=0.98), learner(ON, success_rate=0.0)], "holds"),
    ("fig11", [learner(OFF, success_rate=0.8), learner(ON, success_rate=1.0)], "holds in part"),
    ("fig12", [learner(OFF, success_rate=0.95, no_contact_rate=0.99)], "holds"),
    ("fig12", [learner(OFF, success_rate=1.0, no_contact_rate=0.98)], "holds in part"),
    ("fig14", [learner(learn_solved_all=True, learn_reactions=492, learn_plannings=94)], "holds"),
    (
        "fig14",
        [learner(learn_solved_all=True, learn_reactions=493, learn_plannings=94)],
        "holds in part",
    ),
    ("noise", noises(1.0, 0.98, 0.9), "holds"),
    ("noise", noises(1.0, 0.9, 0.9), "holds in part"),
    ("noise", noises(1.0, 0.89, 0.9), "does not hold"),
    ("timing", [learner(reaction_100_ms=40.0, planning_100_ms=1600.0)], "holds"),
    ("timing", [learner(reaction_100_ms=41.0, planning_100_ms=1600.0)], "does not hold"),
    ("robots", [learner("a", learn_solved_all=n < 9, success_rate=1) for n in range(10)], "holds"),
]


@pytest.mark.parametrize(("name", "rows", "holds"), RULES)
def test_verdicts_follow_the_rules_of_the_page(
    name: str, rows: list[tuple[str, str, Row]], holds: str
) -> None:
    results = [
        Result(Run(name, case, agent, "faithful", "paper_room", "nomad200", 0), row)
        for case, agent, row in rows
    ]
    assert EXPERIMENTS[name].judge(results).holds == holds


@each_experiment
@pytest.mark.parametrize("agent", [STRAIGHT, PLANNER])
def test_baselines_do_their_runs_too(
    experiment: Experiment, agent: str, trained: tuple[Study, Path], small: None
) -> None:
    study, folder = trained
    runs = [run for run in experiment.runs(study) if run.agent == agent]
    if not runs:
        pytest.skip("has no such baseline")
    row = experiment.work(runs[0], folder).row
    assert not any(name.startswith("learn_") for name in row)
    assert 0 <= row.get("success_rate", row.get("suitable", row.get("again", -1))) <= 1


@pytest.mark.parametrize(
    ("name", "case"), [("noise", "±15 %"), ("fig8", "2 m"), ("ablations", "ahead ±45°")]
)
def test_cases_with_a_way_of_their_own_are_done(
    name: str, case: str, trained: tuple[Study, Path], small: None
) -> None:
    study, folder = trained
    experiment = EXPERIMENTS[name]
    run = next(r for r in experiment.runs(study) if (r.case, r.agent) == (case, LEARNER))
    wanted = {row.key for row in experiment.table if row.case == case}
    assert wanted <= set(experiment.work(run, folder).row)


def test_fig10_is_judged_at_each_place_however_many_runs_it_has() -> None:
    def result(case: str, seed: int, reactions: int) -> Result:
        row = {"learn_solved_all": True, "learn_reactions": reactions, "learn_plannings": 9}
        row |= {"scratch_reactions": 500, "scratch_plannings": 9, "old_success_rate": 0.5}
        return Result(Run("fig10", case, LEARNER, "tuned", "paper_room", "nomad200", seed), row)

    goal, clutter = adapting.ADAPTED
    results = [*(result(goal, s, 600) for s in range(20)), result(clutter, 0, 3000)]
    verdict = EXPERIMENTS["fig10"].judge(results)
    assert verdict.holds == "holds in part"
    assert f"in {goal} 20 of 20 runs adapt" in verdict.reason and "3000 react" in verdict.reason
    assert EXPERIMENTS["fig10"].judge(results[:20]).holds == "holds"
    assert EXPERIMENTS["fig10"].judge(results[20:]).holds == "does not hold"


def test_fig13_compares_the_same_seeds() -> None:
    def result(case: str, seed: int, reactions: int) -> Result:
        row = {"soon": True, "learn_reactions": reactions}
        run = Run("fig13", case, LEARNER, "tuned", concave.ROOM, "nomad200", seed)
        return Result(run, row)

    memory, without = concave.MEMORY
    results = [result(memory, seed, 2000 if seed < 2 else 10) for seed in range(20)]
    results += [result(without, seed, 3000) for seed in range(2)]
    verdict = EXPERIMENTS["fig13"].judge(results)
    assert verdict.holds == "holds in part"
    assert "1.5 times as many with the same 2 seeds" in verdict.reason


def test_variants_in_which_nothing_is_different_do_not_count() -> None:
    def result(case: str) -> Result:
        row = {"learn_solved_all": True, "strict_success_rate": 0.9}
        return Result(Run("ablations", case, LEARNER, "tuned", "paper_room", "nomad200", 0), row)

    verdict = EXPERIMENTS["ablations"].judge([result(case) for case in ablations.VARIANTS])
    different = len(ablations.VARIANTS) - 5  # as is, and what `tuned` has already
    assert verdict.reason.startswith(f"{different} of {different} variants")


@pytest.mark.parametrize("robot", ["khepera", "omnibot"])
def test_echoes_are_lost_by_sonars_alone(robot: str) -> None:
    study = Study("tuned", "paper_room", robot, 2)
    cases = {run.case for run in EXPERIMENTS["noise"].runs(study)}
    assert "lost echoes" not in cases and "none" in cases


def test_places_are_others_than_the_room_that_was_learnt(small_room: Path) -> None:
    fig9 = EXPERIMENTS["fig9"]
    for room, wanted in (
        ("clutter", {"goal (2.4, 4.2)", "goal (5, 2)"}),
        (str(small_room), {"clutter", "goal (2.4, 4.2)"}),  # the other goal is in a wall
    ):
        runs = fig9.runs(Study("tuned", room, "nomad200", 1))
        assert {run.case for run in runs} == wanted
    (*_, run) = runs
    assert run.rooms() == (str(small_room), "clutter")
    assert training_run(run).rooms() == (str(small_room),)


def vars_of(result: Result) -> dict[str, object]:
    """Return a result without what differs between machines."""
    return {key: str(value) for key, value in vars(result).items() if key != "machine"}


def any_nan(part: object) -> bool:
    """Whether a NaN, which is unlike itself, is among the numbers."""
    return math.nan.__repr__() in repr(part)


def test_the_way_shown_is_that_of_the_test_that_ended_the_learning(
    trained: tuple[Study, Path], small: None
) -> None:
    study, folder = trained
    experiment = EXPERIMENTS["fig13"]
    result = experiment.work(experiment.runs(study)[0], folder)
    assert result.row["learn_solved_all"] and result.pictures["ways"][0]["reached"]
