"""Tables of experiments: the words in every cell, in the terminal and in Markdown."""

import io

import numpy as np
import pytest
from known_experiment import Known, known_result
from nomad_agents.experiments.experiment import LEARNER, PLANNER, STRAIGHT, TableRow
from nomad_agents.experiments.tables import HEADINGS, for_terminal, make_table, strata
from nomad_agents.studies.runs import Result
from nomad_agents.studies.tables import as_markdown, as_rich
from rich.console import Console

ROWS = (
    TableRow("runs that solve every start", "solved", paper="1 of 1", total=True),
    TableRow("reactions", "reactions", paper="1424"),
    TableRow("goal reached | unseen", "success", digits=2),
    TableRow("SPL", "spl", digits=1),
    TableRow("nobody has it", "nothing", paper="about 7"),
)
GOLDEN = """\
|  | paper | ours: median [quartiles] | ours: IQM (95 %) | straight to the goal | planner at every \
decision |
|---|---:|---:|---:|---:|---:|
| runs that solve every start | 1 of 1 | 3 of 4 |  |  |  |
| reactions | 1424 | 25 [18, 32] | 25 (10, 40) |  |  |
| goal reached \\| unseen |  | 1.00 | 1.00 (1.00, 1.00) | 0.50 | 0.90 [0.85, 0.95] |
| SPL |  | 0.0, 1 of 4 runs | 0.0 |  |  |
| nobody has it | about 7 |  |  |  |  |
"""


@pytest.fixture
def results() -> list[Result]:
    ours = [
        known_result(
            {
                "solved": seed != 2,
                "reactions": 10 * seed + 10,
                "success": 1.0,
                "spl": None if seed else -0.01,
            },
            seed=seed,
        )
        for seed in range(4)
    ]
    straight = [known_result({"success": 0.5}, agent=STRAIGHT)]
    planner = [known_result({"success": 0.8 + 0.2 * s}, agent=PLANNER, seed=s) for s in range(2)]
    return [*ours, *straight, *planner]


def shown(experiment: Known, results: list[Result], width: int = 200) -> str:
    file = io.StringIO()
    console = Console(file=file, width=width, color_system=None)
    console.print(as_rich(for_terminal(make_table(experiment, results))))
    return file.getvalue()


def test_markdown_to_the_letter(results: list[Result]) -> None:
    table = make_table(Known(table=ROWS), results)
    assert table.title == "fig6: Known numbers"
    assert as_markdown(table) == GOLDEN
    assert as_markdown(make_table(Known(table=ROWS), results[::-1])) == GOLDEN


def test_the_terminal_says_the_same(results: list[Result]) -> None:
    text = shown(Known(table=ROWS), results)
    table = make_table(Known(table=ROWS), results)
    assert all(cell in text for row in table.rows for cell in row)
    assert "25 [18, 32]" in text  # brackets are no markup
    assert len({len(line) for line in text.splitlines()[1:]}) == 1


def test_a_column_of_means_that_nobody_has_is_left_out_of_the_terminal(
    results: list[Result],
) -> None:
    text = shown(Known(table=(*ROWS[:1], *ROWS[4:])), results)
    assert "IQM" not in text and "paper" in text and "every decision" in text


def test_cases_apart_and_together() -> None:
    results = [
        known_result({"n": 10.0 * number + seed}, case=case, seed=seed)
        for number, case in enumerate(("near", "far"))
        for seed in range(3)
    ]
    assert [each.tolist() for each in strata(results, "n")] == [[0, 1, 2], [10, 11, 12]]
    assert [each.tolist() for each in strata(results, "n", "far")] == [[10, 11, 12]]
    assert [each.tolist() for each in strata(results, "n", agent=PLANNER)] == [[], []]
    table = make_table(Known(table=(TableRow("n", "n", "far"), TableRow("n", "n"))), results)
    assert [row[2] for row in table.rows] == ["11 [10, 12]", "6 [1, 11]"]


def test_no_results_at_all() -> None:
    table = make_table(Known(table=ROWS), [])
    assert all(row[2:] == ("", "", "", "") for row in table.rows)
    assert table.headings == HEADINGS and as_markdown(table).count("\n") == 7
    assert strata([], "n", agent=LEARNER) == []
    assert np.size(strata([], "n", "far")[0]) == 0
