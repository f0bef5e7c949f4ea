"""What a benchmark is made of: agents by tasks by robots by seeds, as runs."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from nomad_agents.benchmark.run import BenchmarkRun
from nomad_agents.benchmark.sets import Case, TaskSet, write_room
from nomad_agents.learners import find_learner
from nomad_mj.errors import ConfigError
from nomad_mj.scene import build_scene

MOST_SEEDS = 1000  # the seeds of evaluations are far above


@dataclass(frozen=True)
class Plan:
    """What the user chose.

    Attributes
    ----------
    agents : tuple of str
        ``NAME`` or ``NAME:VARIANT`` of `learners.LEARNERS`.
    sets : tuple of TaskSet
        The tasks.
    robots : tuple of str
        Names or files.
    seeds, deep_seeds : int
        Runs of each, with the seeds 0, 1, ...; of each deep learner, if that is less.
    starts, check_starts, budget, whole_curves
        As of `BenchmarkRun`.
    """

    agents: tuple[str, ...]
    sets: tuple[TaskSet, ...]
    robots: tuple[str, ...]
    seeds: int
    deep_seeds: int
    starts: int
    check_starts: int
    budget: int
    whole_curves: bool

    def __post_init__(self) -> None:
        if not 1 <= self.seeds <= MOST_SEEDS:
            raise ConfigError(f"seeds {self.seeds}: must be 1 to {MOST_SEEDS}")
        for name in ("deep_seeds", "starts", "check_starts", "budget"):
            if getattr(self, name) < 1:
                raise ConfigError(f"{name} {getattr(self, name)}: must be 1 or more")
        for name in ("agents", "sets", "robots"):
            if not getattr(self, name):
                raise ConfigError(f"{name}: name one at least")


def plan_runs(plan: Plan, folder: Path) -> list[BenchmarkRun]:
    """Return all runs, seed by seed: whoever stops early has every task, over fewer seeds.

    Parameters
    ----------
    plan : Plan
        What the user chose.
    folder : Path
        Where made rooms are written, so that they can be looked at and driven in.

    Raises
    ------
    NomadError
        A name that stands for nothing, or a robot that does not fit into a room.
    """
    agents = dict.fromkeys(find_learner(spec) for spec in plan.agents)
    for learner, _ in agents:
        learner.check_budget(plan.budget)
    rooms = {case: write_room(case, folder) for each in plan.sets for case in each.cases}
    for name in (names := [Path(robot).stem for robot in dict.fromkeys(plan.robots)]):
        if names.count(name) > 1:
            raise ConfigError(f"robots: two are called {name!r}, and results are kept by name")
    for room in dict.fromkeys(rooms.values()):
        for robot in plan.robots:
            build_scene(room, robot)  # whatever is wrong with them is said now, and once
    return [
        _run(plan, each, case, rooms[case], robot, learner.name, variant, seed)
        for seed in range(plan.seeds)
        for each in plan.sets
        for case in each.cases
        for robot in dict.fromkeys(plan.robots)
        for learner, variant in agents
        if seed < plan.deep_seeds or not learner.deep
    ]


def _run(
    plan: Plan,
    tasks: TaskSet,
    case: Case,
    room: str,
    robot: str,
    agent: str,
    variant: str,
    seed: int,
) -> BenchmarkRun:
    return BenchmarkRun(
        experiment=tasks.name,
        case=case.name,
        agent=agent,
        config=variant,
        room=room,
        robot=robot,
        seed=seed,
        condition=case.condition,
        time_limit=case.time_limit,
        decisions=case.decisions,
        starts=plan.starts,
        check_starts=plan.check_starts,
        budget=plan.budget,
        whole_curves=plan.whole_curves,
    )


def require_extras(agents: Sequence[str]) -> None:
    """Raise ConfigError if an agent cannot learn before something is installed."""
    for spec in agents:
        find_learner(spec)[0].require()
