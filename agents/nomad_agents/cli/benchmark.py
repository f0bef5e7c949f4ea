"""``nomad-mj benchmark``."""

import shlex
from dataclasses import dataclass, field, replace
from pathlib import Path

from rich.console import Console

from nomad_agents.benchmark.numbers import grouped
from nomad_agents.benchmark.plan import Plan, plan_runs, require_extras
from nomad_agents.benchmark.presentation import numbers, present, terminal_tables
from nomad_agents.benchmark.run import BenchmarkRun, work
from nomad_agents.benchmark.sets import SETS, TaskSet, find_set, room_sets
from nomad_agents.cli.common import console, interruptible, output_file, print_json
from nomad_agents.cli.progress import counted_runs
from nomad_agents.learners import usual_agents
from nomad_agents.studies.runs import Result, do_runs, stored_result
from nomad_agents.studies.tables import as_rich
from nomad_mj.envs import DEFAULT_ROBOT
from nomad_mj.errors import ConfigError

_QUICK_SETS, _QUICK_CASES = ("convex", "wide", "concave"), 1
_QUICK_AGENTS = ("straight", "planner", "reactive_planner:tuned")
# How much is done where nothing is said.
_USUAL = {"seeds": 3, "deep_seeds": 5, "starts": 20, "check_starts": 10, "budget": 10000}
_QUICK = {**_USUAL, "seeds": 1, "starts": 8, "check_starts": 4, "budget": 300}


@dataclass(frozen=True)
class Benchmark:
    """Compare agents on the same tasks, with the field's metrics, over rooms and seeds.

    Agents: those of `nomad-mj list`, with a variant after a colon where they have some:
    reactive_planner:faithful, sac:ranges. Sets: convex wide concave moving noisy maze.
    """

    agents: tuple[str, ...] = field(default_factory=usual_agents)
    """Who; by default all but the deep learners, which take hours (sac, td3, ppo)."""
    sets: tuple[str, ...] = ()
    """Standard sets of tasks; all by default, none where only --rooms are given."""
    rooms: tuple[str, ...] = ()
    """Names of rooms, or MJCF files, each a set of its own."""
    robots: tuple[str, ...] = (DEFAULT_ROBOT,)
    """Names of robots, or MJCF files."""
    seeds: int | None = None
    """Runs of each agent in each task, with the seeds 0, 1, ...; 3, or 1 with --quick."""
    deep_seeds: int | None = None
    """Of deep learners, if that is less than --seeds; 5 by default."""
    starts: int | None = None
    """Unseen starts that every run is evaluated from; 20, or 8 with --quick."""
    check_starts: int | None = None
    """Other unseen starts, from which learners are checked now and then while they learn; 10, or
    4 with --quick."""
    budget: int | None = None
    """Decisions of learning, at most; 10000, or 300 with --quick."""
    curves: bool = False
    """Check learners all along, not only until 90 % are mastered, for whole learning curves."""
    quick: bool = False
    """A look in about two minutes: three agents, one room of three sets, one seed."""
    jobs: int = 2
    """Processes."""
    out: str = "renders"
    """Folder for benchmark.html and, under benchmark/, a file a run, tables, rows and figures."""
    only_read: bool = False
    """Run nothing: show what is on file."""
    json: bool = False
    """Print one line of JSON last on standard output."""

    def run(self) -> int:
        """Run what is missing, then write tables, rows, figures and the page."""
        if self.jobs < 1:
            raise ConfigError(f"jobs {self.jobs}: must be 1 or more")
        plan = self._plan()
        if not self.only_read:
            require_extras(plan.agents)
        screen = console(json_wanted=self.json)
        page = output_file(self.out, self._name, ".html")
        folder = page.parent / self._name / "runs"
        with interruptible():
            runs = plan_runs(plan, folder.parent / "rooms")
            results = self._results(runs, folder, screen)
            if not results:
                raise ConfigError(f"{folder} holds no such run; run without --only-read")
            for table in terminal_tables(grouped(results)):
                screen.print(as_rich(table))
            with screen.status("drawing"):
                present(results, self._command(), folder.parent, page)
        screen.print(f"All tables: {folder.parent / 'tables.md'}; page: {page}", soft_wrap=True)
        if self.json:
            print_json(numbers(results))
        return 0

    @property
    def _name(self) -> str:
        return "benchmark-quick" if self.quick else "benchmark"

    def _sets(self) -> tuple[TaskSet, ...]:
        wanted = self.sets or (() if self.rooms else tuple(SETS))
        if self.quick and not self.sets and not self.rooms:
            wanted = _QUICK_SETS
        sets = [find_set(name) for name in dict.fromkeys(wanted)]
        if self.quick:
            sets = [replace(each, cases=each.cases[:_QUICK_CASES]) for each in sets]
        return (*sets, *room_sets(self.rooms))

    def _plan(self) -> Plan:
        agents = self.agents
        if self.quick and agents == usual_agents():
            agents = _QUICK_AGENTS
        return Plan(
            agents=agents,
            sets=self._sets(),
            robots=self.robots,
            whole_curves=self.curves,
            **{name: self._size(name) for name in _USUAL},
        )

    def _size(self, name: str) -> int:
        """Return how much of something is done, as the option says or by default."""
        given: int | None = getattr(self, name)
        return (_QUICK if self.quick else _USUAL)[name] if given is None else given

    def _results(self, runs: list[BenchmarkRun], folder: Path, screen: Console) -> list[Result]:
        """Return the results, with a progress bar over all runs."""
        if self.only_read:
            held = (stored_result(run, folder) for run in runs)
            return [result for result in held if result is not None]
        with counted_runs(screen, len(runs), folder) as after_run:
            return do_runs(runs, work, folder, self.jobs, after_run)

    def _command(self) -> str:
        """Return what to type to get the same."""
        words = ["nomad-mj", "benchmark"]
        usual = Benchmark()
        for name in ("agents", "sets", "rooms", "robots"):
            if getattr(self, name) != getattr(usual, name):
                words += [f"--{name}", *getattr(self, name)]
        for name in _USUAL:
            if getattr(self, name) is not None:
                words += [f"--{name.replace('_', '-')}", str(getattr(self, name))]
        words += [f"--{name}" for name in ("curves", "quick") if getattr(self, name)]
        return shlex.join(words)
