"""``nomad-mj reproduce``."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro
from rich.console import Console

from nomad_agents.cli.common import console, interruptible, output_file, print_json
from nomad_agents.cli.progress import counted_runs
from nomad_agents.experiments.experiment import Experiment, Study
from nomad_agents.experiments.paper import EXPERIMENTS, EXTRA
from nomad_agents.experiments.presentation import find, numbers, present
from nomad_agents.experiments.reproduction import Results, count_runs, on_file, reproduce
from nomad_agents.experiments.tables import for_terminal
from nomad_agents.paths import expanded
from nomad_agents.registry import find_config
from nomad_agents.studies.tables import as_rich
from nomad_mj.envs import DEFAULT_ROBOT, DEFAULT_ROOM
from nomad_mj.errors import ConfigError, UnknownNameError
from nomad_mj.scene import build_scene

ALL = "all"


@dataclass(frozen=True)
class Reproduce:
    """Repeat the paper's experiments over many seeds, beside the baselines, into one report.

    Experiments: fig6 fig7 fig8 fig9 fig10 fig11 fig12 fig13 fig14 noise timing, or all of these;
    by their own names only robots (five robots in four rooms) and ablations (every reading of the
    text against its alternatives).
    """

    experiments: Annotated[tuple[str, ...], tyro.conf.Positional] = (ALL,)
    """Which, one or several."""
    seeds: int = 20
    """Runs, with the seeds 0, 1, ...; at most 3 of each baseline, which learns nothing."""
    config: str = "faithful"
    """Parameters: faithful (the paper's) or tuned (fewer virtual collisions in such rooms)."""
    room: str = DEFAULT_ROOM
    """Name of a room, or an MJCF file; fig13 and parts of fig9 and fig10 have their own."""
    robot: str = DEFAULT_ROBOT
    """Name of a robot, or an MJCF file."""
    jobs: int = 2
    """Processes."""
    out: str = "renders"
    """Folder for report.html and, under reproduce/CONFIG, one file a run, tables and figures."""
    no_videos: bool = False
    """Record no video of each experiment."""
    only_read: bool = False
    """Run nothing: show what is on file."""
    json: bool = False
    """Print one line of JSON last on standard output."""

    def run(self) -> int:
        """Run what is missing, then write tables, figures, videos and the report."""
        if self.seeds < 1 or self.jobs < 1:
            raise ConfigError(f"seeds {self.seeds}, jobs {self.jobs}: must be 1 or more")
        experiments = choose(self.experiments)
        find_config(self.config)
        study = Study(self.config, self.room, self.robot, self.seeds)
        _check_scenes(experiments, study)
        screen = console(json_wanted=self.json)
        if expanded(self.out).suffix == ".html" and not expanded(self.out).is_dir():
            raise ConfigError(f"out {self.out!r}: must be a folder")
        report = output_file(self.out, "report", ".html")
        folder = output_file(
            str(Path(self.out, "reproduce", self.config, "runs")), "probe", ".csv"
        ).parent
        with interruptible():
            results = self._results(experiments, study, folder, screen)
            findings = find(experiments, results, study)
            if not findings:
                raise ConfigError(
                    f"{folder} holds no experiment of {', '.join(self.experiments)} with a run of "
                    "every case; run without --only-read"
                )
            for finding in findings:
                screen.print(as_rich(for_terminal(finding.table)))
                screen.print(f"{finding.verdict.holds}: {finding.verdict.reason}", soft_wrap=True)
            with screen.status("") as status:
                remarks = present(
                    findings,
                    results,
                    study,
                    folder,
                    report,
                    videos=not self.no_videos,
                    tell=status.update,
                )
        for line in [*remarks, f"Report: {report}"]:
            screen.print(line, soft_wrap=True)
        if self.json:
            told = {
                each.name: {"verdict": verdict.holds, "numbers": numbers(each, results[each.name])}
                for each, _, verdict in findings
            }
            print_json(told)
        return 0

    def _results(
        self, experiments: list[Experiment], study: Study, folder: Path, screen: Console
    ) -> Results:
        """Return the results, with a progress bar over all runs."""
        if self.only_read:
            return on_file(experiments, study, folder)
        with counted_runs(screen, count_runs(experiments, study), folder) as after_run:
            return reproduce(experiments, study, folder, self.jobs, after_run)


def _check_scenes(experiments: Sequence[Experiment], study: Study) -> None:
    """Build each scene of the runs: whatever is wrong with rooms and robots is said now, once."""
    build_scene(study.room, study.robot)  # of which the runs may depend
    used = {(run.room, run.robot): None for each in experiments for run in each.runs(study)}
    used.pop((study.room, study.robot), None)
    for room, robot in used:
        build_scene(room, robot)


def choose(names: tuple[str, ...]) -> list[Experiment]:
    """Return the experiments of some names, in the catalogue's order.

    Raises
    ------
    UnknownNameError
        A name that no experiment has.
    """
    for name in names:
        if name not in (*EXPERIMENTS, ALL):
            raise UnknownNameError("experiment", name, [*EXPERIMENTS, ALL])
    wanted = set(names)
    if ALL in wanted or not wanted:
        wanted |= set(EXPERIMENTS) - set(EXTRA)
    return [each for name, each in EXPERIMENTS.items() if name in wanted]
