"""From results on file to what people look at: tables, figures, videos and the report."""

import shlex
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from nomad_agents.checkpoint import write_atomically
from nomad_agents.experiments.experiment import (
    LEARNER,
    PLANNER,
    STRAIGHT,
    Experiment,
    Study,
    Verdict,
)
from nomad_agents.experiments.illustrate import Illustration, illustrate
from nomad_agents.experiments.learnt import TRAINING
from nomad_agents.experiments.report import NoVideo, Section, Video, provenance, write_report
from nomad_agents.experiments.reproduction import Results, count_runs, trainings
from nomad_agents.experiments.showreel import film
from nomad_agents.experiments.tables import make_table, strata
from nomad_agents.studies.export import export
from nomad_agents.studies.runs import Result, Run
from nomad_agents.studies.statistics import spread
from nomad_agents.studies.tables import TextTable, as_markdown
from nomad_mj.envs import DEFAULT_ROBOT, DEFAULT_ROOM

PARTIAL = "%d of %d runs so far"


class Finding(NamedTuple):
    """An experiment's table and what it says of the paper's claim."""

    experiment: Experiment
    table: TextTable
    verdict: Verdict


def find(experiments: Sequence[Experiment], results: Results, study: Study) -> list[Finding]:
    """Return the findings of experiments of which every case has a result.

    Where runs are missing the verdict says so.
    """
    return [
        Finding(each, make_table(each, results[each.name]), _judge(each, results, study))
        for each in experiments
        if (parts := _parts(each.runs(study)))  # else nothing of it makes sense in this room
        and parts <= _parts(result.run for result in results[each.name])
    ]


def _judge(experiment: Experiment, results: Results, study: Study) -> Verdict:
    there, wanted = len(results[experiment.name]), len(experiment.runs(study))
    holds, reason = experiment.judge(results[experiment.name])
    return Verdict(holds, reason if there == wanted else f"{reason} ({PARTIAL % (there, wanted)})")


def _parts(runs: Iterable[Run]) -> set[tuple[str, str]]:
    return {(run.case, run.agent) for run in runs}


def command(experiment: Experiment, study: Study) -> str:
    """Return what to type to get an experiment of a study."""
    words = ["nomad-mj", "reproduce", experiment.name, "--seeds", str(study.seeds)]
    words += ["--config", study.config]
    if study.room != DEFAULT_ROOM:
        words += ["--room", study.room]
    if study.robot != DEFAULT_ROBOT:
        words += ["--robot", study.robot]
    return shlex.join(words)


def write_tables(findings: Sequence[Finding], study: Study, path: Path) -> None:
    """Write all tables and verdicts as Markdown."""
    parts = [
        f"## {title}\n\n{each.claim} ({each.source})\n\n"
        f"`{command(each, study)}`\n\n{as_markdown(table)}\n**{holds}**: {reason}.\n"
        for each, table, (holds, reason) in findings
        for title in (table.title,)
    ]
    write_atomically(path, lambda file: file.write("\n".join(parts).encode()))


def present(
    findings: Sequence[Finding],
    results: Results,
    study: Study,
    runs: Path,
    report: Path,
    *,
    videos: bool,
    tell: Callable[[str], object],
) -> list[str]:
    """Write tables, CSV files, figures, videos and the report; return remarks for the user.

    Parameters
    ----------
    findings, results, study
        What there is to show.
    runs : Path
        Where the runs are on file; all but the report goes beside it.
    report : Path
        The page, ``.html``.
    videos : bool
        Whether to record those that are missing.
    tell : callable
        Called with what is being done.

    Raises
    ------
    OutputError
        Something cannot be written.
    """
    folder = runs.parent
    every = [result for held in results.values() for result in held]
    export(every, folder)
    write_tables(findings, study, folder / "tables.md")
    sections: list[Section] = []
    for finding in findings:
        tell(f"drawing {finding.experiment.name}")
        pictures = illustrate(finding.experiment, every, folder / "figures")
        shown: Video | NoVideo = NoVideo("Videos were not asked for.")
        if videos:
            tell(f"recording {finding.experiment.name}")
            name = f"{finding.experiment.name}.mp4"
            shown = film(finding.experiment, study, runs, folder / "videos" / name)
        sections.append(_section(finding, study, pictures, shown))
    tell("writing the report")
    made = _provenance([finding.experiment for finding in findings], results, study)
    usual = (study.room, study.robot) == (DEFAULT_ROOM, DEFAULT_ROBOT)
    write_report(report, sections, made, seeds=study.seeds, introduced=usual)
    missing = {s.video.reason for s in sections if videos and isinstance(s.video, NoVideo)}
    return [f"no video: {reason}" for reason in sorted(missing)]


def _provenance(
    experiments: Sequence[Experiment], results: Results, study: Study
) -> list[tuple[str, str]]:
    """Return where the numbers of some experiments, and what these begin with, come from."""
    lessons = set(trainings(experiments, study))
    behind = [result for result in results.get(TRAINING, ()) if result.run in lessons]
    behind += [result for each in experiments for result in results[each.name]]
    return provenance(study, behind, count_runs(experiments, study))


def _section(
    finding: Finding, study: Study, pictures: Sequence[Illustration], shown: Video | NoVideo
) -> Section:
    each, table, verdict = finding
    # Drawn as .pdf for print and .png for the screen.
    shown_pictures = [p._replace(path=p.path.with_name(f"{p.path.name}.png")) for p in pictures]
    return Section(
        each.name,
        each.title,
        each.claim,
        each.source,
        verdict,
        table,
        shown_pictures,
        shown,
        command(each, study),
    )


def numbers(experiment: Experiment, results: Sequence[Result]) -> dict[str, dict[str, Any]]:
    """Return the numbers behind an experiment's table, by label and agent."""
    told: dict[str, dict[str, Any]] = {}
    for row in experiment.table:
        agents = {
            agent: spread(strata(results, row.key, row.case, agent))._asdict()
            for agent in (LEARNER, STRAIGHT, PLANNER)
        }
        told[row.label] = {"paper": row.paper}
        told[row.label] |= {agent: held for agent, held in agents.items() if held["count"]}
    return told
