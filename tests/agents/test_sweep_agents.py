"""Sweeps over every agent: each comes to be in its own way, and is told its own options."""

from dataclasses import asdict
from pathlib import Path

import pytest
from nomad_agents.checkpoint import save_checkpoint
from nomad_agents.deep import LEARNERS as DEEP
from nomad_agents.learners import LEARNERS
from nomad_agents.reactive_planner import FAITHFUL, ReactivePlanner
from nomad_agents.studies.runs import Row
from nomad_agents.sweeps.grid import Grid, SweepRun, read_grid
from nomad_agents.sweeps.options import catalogue
from nomad_agents.sweeps.store import as_table
from nomad_agents.sweeps.work import check_grid, do_run, sources
from nomad_agents.training import Training

import nomad_mj

# Whatever learns does so briefly, and all are evaluated from one start.
BRIEF = (
    *("robot=omnibot", "evaluate.max_decisions=2", "max_passes=1", "episode_decisions=2"),
    *("test_decisions=1", "decisions=12", "sac.learning_starts=4", "td3.learning_starts=4"),
    *("sac.batch_size=4", "td3.batch_size=4", "ppo.rollout=6", "ppo.batch_size=6"),
)


def grid_of(room: Path, *words: str) -> Grid:
    names = {word.partition("=")[0] for word in words}
    agents = next(word for word in words if word.startswith("agent=")).partition("=")[2].split(",")
    known = catalogue()
    brief = [
        word
        for word in BRIEF
        if (name := word.partition("=")[0]) not in names
        and any(known[name].is_of(agent) for agent in agents)
    ]
    return read_grid([f"room={room}", *words, *brief], "", "1", 1)


def done(grid: Grid) -> dict[SweepRun, Row]:
    return {run: do_run(sources(grid), run) for run in grid.runs()}


def told(row: Row) -> Row:
    """Return the numbers of an evaluation that a NaN does not spoil."""
    names = ("success_rate", "spl", "min_clearance_m", "virtual_collisions", "bumper_contacts")
    return {name: row[name] for name in names}


def test_agents_that_learn_nothing_are_evaluated_and_told_their_settings(
    small_room: Path, tmp_path: Path
) -> None:
    behind_the_box = tmp_path / "starts.csv"
    behind_the_box.write_text("0,-0.5,1.5\n")
    names = [name for name, each in LEARNERS.items() if not each.learns]
    words = [f"agent={','.join(names)}", f"starts={behind_the_box}", "evaluate.max_decisions=6"]
    own = ["dwa.heading=2.0,0.0", "vfh.safety=0.15,0.45", "potential.repulsion=0.03,0.001"]
    grid = grid_of(small_room, *words, *own)
    check_grid(grid, lambda _: None)
    rows = done(grid)
    assert len(rows) == len(names) + 3 and {"straight", "random", "planner"} < set(names)
    found: dict[str, list[Row]] = {name: [] for name in names}
    for run, row in rows.items():
        found[str(dict(run.cell)["agent"])].append(told(row))
        assert not any(name.startswith("learn_") for name in row)
    assert {name for name, each in found.items() if len(each) == 2} == {"vfh", "dwa", "potential"}
    for name in ("vfh", "dwa", "potential"):
        assert found[name][0] != found[name][1], name
    table = as_table(grid, rows)
    heading = dict(zip(table["agent"].to_pylist(), table["dwa.heading"].to_pylist(), strict=True))
    assert heading["vfh"] is None and heading["dwa"] == 0.0


@pytest.mark.parametrize("name", DEEP)
def test_deep_learners_learn_from_their_budget_with_their_settings(
    small_room: Path, name: str
) -> None:
    pytest.importorskip("stable_baselines3")
    grid = grid_of(
        small_room,
        f"agent={name}",
        f'{name}.hidden="8,8","4"',
        "observation=ranges",
        "decisions=12",
    )
    rows = list(done(grid).values())
    for row in rows:
        assert row["learn_decisions"] == 12 and row["learn_sim_s"] > 5 and row["episodes"] == 1
        assert row["version_torch"] and row["version_stable-baselines3"]
    assert rows[0]["learn_sim_s"] != rows[1]["learn_sim_s"]


def test_a_checkpoint_is_driven_beside_those_that_learn(small_room: Path, tmp_path: Path) -> None:
    path = tmp_path / "new.npz"
    with nomad_mj.load("path_finding", small_room, "omnibot") as env:
        agent = ReactivePlanner(env.scene.robot.layout, FAITHFUL)
    save_checkpoint(path, agent, "small", "omnibot", asdict(Training()) | {"seed": 0})
    grid = grid_of(small_room, f"agent={path},reactive_planner", "k_ind=0.02,0.1")
    assert sources(grid)["files"].keys() == {f"room {small_room}", "robot omnibot", str(path)}
    rows = done(grid)
    assert [dict(run.cell)["k_ind"] for run in rows] == [None, 0.02, 0.1]
    learnt = [row.get("learn_decisions", 0) for row in rows.values()]
    assert learnt[0] == 0 < min(learnt[1:])
