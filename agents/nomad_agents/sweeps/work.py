"""What a run of a sweep does: train an agent, then evaluate it; and what is checked before."""

import platform
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

from nomad_agents.agent import Agent
from nomad_agents.evaluation import draw_starts, evaluate, read_starts, summarise
from nomad_agents.experiments.learnt import learn
from nomad_agents.experiments.measures import UNSEEN_SEED
from nomad_agents.experiments.runs import PACKAGES, Row, Stopwatch, describe_machine, digest
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.registry import AGENTS, find_agent
from nomad_agents.sweeps.grid import Cell, Grid, SweepRun, describe
from nomad_agents.sweeps.options import AGENT, CONFIG, STARTS, Settings, catalogue, settle
from nomad_mj.assets import find_robot, find_room
from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError, NomadError, WorkerError
from nomad_mj.types import FloatArray

MACHINE = "machine_"
VERSIONS = "version_"


def do_run(wanted: Row, run: SweepRun) -> Row:
    """Return the numbers of a run, and under ``machine_...`` where and how long it was done.

    An agent that learns is trained with the seed, then evaluated from starts that are the same for
    all seeds and that no training sees; a checkpoint and an agent that does not learn are
    evaluated.

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
        _require_same(wanted, run)
        settings = settle(dict(run.cell), run.seed)
        with settings.task.path_finding() as env:
            agent, row = _agent(env, settings)
            starts = _starts(env, settings.starts)
            seed = UNSEEN_SEED + run.seed
            trials = evaluate(env, agent, starts, seed, settings.max_decisions)
            row = dict(summarise(env, trials)) | row
    except NomadError as error:
        raise WorkerError(f"{run}: {error}") from None
    machine = describe_machine(stopwatch)
    versions = {f"{VERSIONS}{name}": value for name, value in package_versions().items()}
    return row | versions | {f"{MACHINE}{name}": value for name, value in machine.items()}


def _require_same(wanted: Row, run: SweepRun) -> None:
    axes = tuple((name, (value,)) for name, value in run.cell)
    for kind, found in sources(Grid(axes, 1)).items():
        for name, value in found.items():
            if value != wanted[kind].get(name):
                raise ConfigError(
                    f"{platform.node()} has another {name} than the machine that began the sweep"
                )


def package_versions() -> dict[str, str]:
    """Return the versions of the packages that numbers depend on."""
    return {name: version(name) for name in PACKAGES}


def _agent(env: PathFinding, settings: Settings) -> tuple[Agent, Row]:
    """Return the agent to evaluate, and what its training took."""
    agent = find_agent(settings.agent, env.scene.robot.layout, settings.config)
    if not isinstance(agent, ReactivePlanner) or settings.agent not in AGENTS:
        return agent, {}
    return agent, learn(env, agent, settings.training)[0]


def _starts(env: PathFinding, starts: str) -> FloatArray:
    """Return the starts (n, 3): so many unseen ones, or those of a file."""
    if starts.lstrip("+-").isdigit():
        return draw_starts(env, int(starts), UNSEEN_SEED)
    return read_starts(Path(starts))


def check_grid(grid: Grid, tell: Callable[[str], object]) -> None:
    """Find what is wrong with a grid before anything of it is run.

    Every combination is put together, and every value is tried in a room once.

    Raises
    ------
    NomadError
        The first mistake, and in which combination.
    """
    names = dict(grid.axes)
    stored = [str(agent) for agent in names.get(AGENT, ()) if agent not in AGENTS]
    known = catalogue()
    useless = [n for n in names if n == CONFIG or known[n].part in ("train", "agent")]
    if stored and useless:
        raise ConfigError(
            f"sweep: checkpoint {stored[0]!r} has its own parameters and is not trained; leave out "
            f"{', '.join(useless)}"
        )
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
    with settings.task.path_finding() as env:
        find_agent(settings.agent, env.scene.robot.layout, settings.config)
        _starts(env, settings.starts)
        env.reset(seed=0)


def sources(grid: Grid) -> Row:
    """Return what else numbers depend on: versions of packages, content of files."""
    values = dict(grid.axes)
    task = settle({}, 0).task
    files = [find_room(str(v)) for v in values.get("room", (task.room,))]
    files += [find_robot(str(v)) for v in values.get("robot", (task.robot,))]
    files += [Path(str(v)).expanduser() for v in values.get(AGENT, ()) if v not in AGENTS]
    files += [Path(str(v)).expanduser() for v in values.get(STARTS, ()) if not str(v).isdigit()]
    return {
        "packages": package_versions(),
        "files": {path.name: digest(path) for path in files if path.is_file()},
    }
