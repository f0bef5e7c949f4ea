"""What takes long to import waits until it is needed: a command starts in about a second."""

import subprocess
import sys

import pytest

HEAVY: tuple[str, ...] = ("gymnasium", "matplotlib", "pyarrow", "ray", "scipy", "torch")


def imported(statement: str) -> set[str]:
    """Return which heavy packages a new interpreter has imported after a statement."""
    told = subprocess.run(
        [sys.executable, "-c", f"{statement}\nimport sys; print(*sys.modules)"],
        capture_output=True,
        text=True,
        check=True,
    )
    return set(HEAVY) & set(told.stdout.split())


@pytest.mark.parametrize(
    "statement",
    [
        "import nomad_mj",
        "import nomad_agents",
        "from nomad_agents.cli.main import main",
        "import nomad_agents.cli.listing",
        "import nomad_agents.experiments.paper",  # what each process of `reproduce` needs
    ],
)
def test_nothing_heavy_is_imported_before_it_is_needed(statement: str) -> None:
    assert imported(statement) == set()


def test_what_is_needed_is_seen() -> None:
    assert imported("import scipy.sparse") == {"scipy"}
