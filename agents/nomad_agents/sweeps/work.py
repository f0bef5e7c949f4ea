"""What a run of a sweep does: let an agent learn, then evaluate it; and what is checked before."""

import platform
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, closing, nullcontext
from importlib.metadata import version
from pathlib import Path
from typing import Any

import nomad_mj
from nomad_agents.deep.extra import DEEP_PACKAGES
from nomad_agents.evaluation import draw_starts, evaluate, read_starts, summarise
from nomad_agents.learners import LEARNERS, Lesson
from nomad_agents.paths import expanded
from nomad_agents.registry import AGENTS, make_agent
from nomad_agents.studies.digest import digest
from nomad_agents.studies.measures import UNSEEN_SEED
from nomad_agents.studies.runs import PACKAGES, Row, Stopwatch, describe_machine
from nomad_agents.sweeps.grid import Cell, Grid, SweepRun, describe
from nomad_agents.sweeps.options import AGENT, STARTS, USUAL_AGENT, Value
from nomad_agents.sweeps.settings import Settings, settle
from nomad_mj.assets import find_robot, find_room
from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError, NomadError, WorkerError
from nomad_mj.robots import find_sheet
from nomad_mj.types import FloatArray

MACHINE = "machine_"
VERSIONS = "version_"


def do_run(wanted: Row, run: SweepRun) -> Row:
    """Return the numbers of a run, and under ``machine_...`` where and how long it was done.

    An agent that learns does so with the seed, then it is evaluated from starts that are the same
    for all seeds and that no training sees; a checkpoint and an agent that does not learn are
    evaluated as they are.

    Parameters
    ----------
    wanted : dict
        `sources` where the sweep was begun: numbers made from others do not belong with its.
    run : SweepRun
        What to do.

    Raises
    ------
    WorkerError
        What is wrong with its options, and which they are.
    """
    stopwatch = Stopwatch()
    try:
        settings = settle(dict(run.cell), run.seed)
        learner = settings.learner()
        learner.require()
        _require_same(wanted, run)
        with settings.task.path_finding() as env:
            agent, row = learner.learn(_lesson(env, settings))
            starts = _starts(env, settings.starts)
            seed = UNSEEN_SEED + run.seed
            trials = evaluate(env, agent, starts, seed, settings.max_decisions)
            row = dict(summarise(env, trials)) | row
    except NomadError as error:
        raise WorkerError(f"{run}: {error}") from None
    machine = describe_machine(stopwatch)
    packages = package_versions([settings.agent])
    versions = {f"{VERSIONS}{name}": value for name, value in packages.items()}
    row = {name: value for name, value in row.items() if value == value}  # NaN: it has none
    return row | versions | {f"{MACHINE}{name}": value for name, value in machine.items()}


def _require_same(wanted: Row, run: SweepRun) -> None:
    axes = tuple((name, (value,)) for name, value in run.cell if value is not None)
    for kind, found in sources(Grid(axes, 1)).items():
        for name, value in found.items():
            if value != wanted[kind].get(name):
                raise ConfigError(
                    f"{platform.node()} has another {name} than the machine that began the sweep"
                )


def package_versions(agents: Sequence[Value]) -> dict[str, str]:
    """Return the versions of the packages that the numbers of some agents depend on."""
    deep = any(learner.deep for name, learner in LEARNERS.items() if name in agents)
    return {name: version(name) for name in (*PACKAGES, *(DEEP_PACKAGES if deep else ()))}


def _lesson(env: PathFinding, settings: Settings) -> Lesson:
    """Return what is to be learnt; the task is that of the evaluation, unless it is altered."""
    task = settings.task.load_options()

    def opened(**task_kwargs: Any) -> AbstractContextManager[PathFinding]:
        if not task_kwargs:
            return nullcontext(env)
        return closing(nomad_mj.load("path_finding", **(task | task_kwargs)))

    return Lesson(settings.variant(), settings.training.seed, settings.budget, opened, task)


def _starts(env: PathFinding, starts: str) -> FloatArray:
    """Return the starts (n, 3): so many unseen ones, or those of a file."""
    try:
        count = int(starts)
    except ValueError:
        return read_starts(Path(starts))
    return draw_starts(env, count, UNSEEN_SEED)


def check_grid(grid: Grid, tell: Callable[[str], object]) -> None:
    """Find what is wrong with a grid before anything of it is run.

    Every combination is put together, and every value is tried in a room once.

    Raises
    ------
    NomadError
        The first mistake, and in which combination.
    """
    for cell in grid.cells():
        _tell_where(cell, lambda cell: settle(dict(cell), 0))
    for number, cell in enumerate(grid.probes(), 1):
        tell(f"checking {number}: {describe(cell)}")
        _tell_where(cell, _try)


def _tell_where(cell: Cell, check: Callable[[Cell], object]) -> None:
    try:
        check(cell)
    except NomadError as error:
        raise ConfigError(f"sweep: {describe(cell)}: {error}") from None


def _try(cell: Cell) -> None:
    settings = settle(dict(cell), 0)
    learner = settings.learner()
    with settings.task.path_finding() as env:
        if not learner.learns:
            learner.learn(_lesson(env, settings))
        elif settings.agent in AGENTS:
            make_agent(settings.agent, env.scene.robot.layout, settings.config)
        _starts(env, settings.starts)
        env.reset(seed=0)


def require_extras(grid: Grid) -> None:
    """Raise ConfigError if an agent cannot learn before something is installed."""
    for agent in _agents(grid):
        if agent in LEARNERS:
            LEARNERS[str(agent)].require()


def sources(grid: Grid) -> Row:
    """Return what else numbers depend on: versions of packages, content of files."""
    values, agents = dict(grid.axes), _agents(grid)
    task = settle({}, 0).task
    files = {f"room {v}": find_room(str(v)) for v in values.get("room", (task.room,))}
    robots = {f"robot {v}": find_robot(str(v)) for v in values.get("robot", (task.robot,))}
    own = [v for v in agents if v not in LEARNERS]
    own += [v for v in values.get(STARTS, ()) if not str(v).isdigit()]
    files |= {str(v): expanded(str(v)) for v in own}
    return {
        "packages": package_versions(agents),
        "files": {name: digest(path) for name, path in files.items() if path.is_file()}
        | {name: digest(path, find_sheet(path)) for name, path in robots.items()},
    }


def _agents(grid: Grid) -> tuple[Value, ...]:
    return dict(grid.axes).get(AGENT, (USUAL_AGENT,))
