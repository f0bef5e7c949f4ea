"""An experiment of no work, whose results are made up by the tests."""

from collections.abc import Sequence
from pathlib import Path

from nomad_agents.experiments.experiment import (
    LEARNER,
    Experiment,
    Showcase,
    Study,
    TableRow,
    Verdict,
)
from nomad_agents.studies.runs import Result, Row, Run


class Known(Experiment):
    """Has a name and a table; what is done in it is told, not done."""

    title, claim, source = "Known numbers", "They are known.", "nowhere"

    def __init__(self, name: str = "fig6", table: tuple[TableRow, ...] = ()) -> None:
        self.name = name
        self.table = table

    def runs(self, study: Study) -> list[Run]:
        return self.plan_runs(study, ("",), ())

    def work(self, run: Run, folder: Path) -> Result:
        raise NotImplementedError

    def judge(self, results: Sequence[Result]) -> Verdict:
        raise NotImplementedError

    def showcase(self, study: Study, folder: Path) -> Showcase:
        raise NotImplementedError


def known_result(
    row: Row | None = None,
    *,
    name: str = "fig6",
    case: str = "",
    agent: str = LEARNER,
    room: str = "paper_room",
    seed: int = 0,
    pictures: Row | None = None,
    curve: Sequence[Row] = (),
) -> Result:
    run = Run(name, case, agent, "faithful", room, "nomad200", seed)
    return Result(run, row or {}, curve=list(curve), pictures=pictures or {})
