"""Every snippet of the documentation runs, and prints what the page says it prints.

By the fence: `yaml` is written, first of all, to the file that its first line names; `xml` is a
room or robot, written likewise and loaded; `python` and `sh` are run, in the order of the page, in
one folder; `text output` is what the snippet before prints. A second word `gl` asks for OpenGL,
`screen` for a display: without one the snippet is compiled only. Plain `text`, `mermaid` and others
are not run.
"""

import contextlib
import io
import os
import pkgutil
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from nomad_agents.cli.main import COMMANDS, main
from nomad_agents.cli.parsing import parse
from nomad_agents.reactive_planner import FAITHFUL, TUNED

import nomad_mj
from nomad_mj._gl import gl_report
from nomad_mj.motion import SAFE_CLEARANCE, MotionConfig
from nomad_mj.tasks import MotorConfig

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGES = sorted(DOCS.glob("*.md"))
README = DOCS.parent / "README.md"
FENCE = re.compile(r"^```(\w+)(?: (\w+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"<!-- (\S+\.xml) -->")
SHEET = re.compile(r"# (\S+\.yaml)\n")


class Snippet(NamedTuple):
    language: str
    word: str
    text: str


def snippets(page: Path) -> list[Snippet]:
    found = FENCE.findall(page.read_text(encoding="utf-8"))
    return [Snippet(*parts) for parts in found]


def load_file(path: Path) -> None:
    """Load a room or a robot, whichever it is."""
    kind = "robot" if "<actuator>" in path.read_text() else "room"
    files: dict[str, Any] = {kind: path}
    with nomad_mj.load("path_finding", **files) as env:
        env.reset(seed=0)


def run_python(text: str, where: str, names: dict[str, Any]) -> str:
    code = compile(text, where, "exec")
    with contextlib.redirect_stdout(io.StringIO()) as output:
        exec(code, names)
    return output.getvalue()


def run_shell(text: str, where: str, folder: Path) -> str:
    """Run a snippet; in this process, which is faster, what is nothing but our own commands."""
    lines = text.replace("\\\n", " ").splitlines()
    if all(re.fullmatch(r"nomad-mj (?!.*--help)[\w ./:=,-]*", line) for line in lines):
        with contextlib.redirect_stdout(io.StringIO()) as output:
            for line in lines:
                assert main(shlex.split(line)[1:]) == 0, f"{where}: {line}"
        return output.getvalue()
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    ran = subprocess.run(
        ["bash", "-ec", text],
        cwd=folder,
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, f"{where}: {ran.stderr}"
    return ran.stdout


def possible(snippet: Snippet) -> bool:
    if snippet.word == "screen":
        return False
    return snippet.word != "gl" or gl_report().works


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_snippets_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"__name__": page.stem}
    printed: str | None = None
    for snippet in snippets(page):
        if snippet.language == "yaml" and (name := SHEET.match(snippet.text)):
            Path(name[1]).write_text(snippet.text)
    for number, snippet in enumerate(snippets(page), 1):
        where = f"{page.name}, snippet {number}"
        if snippet.language == "xml":
            name = FILE.match(snippet.text)
            assert name, f"{where}: its first line must name its file"
            Path(name[1]).write_text(snippet.text)
            load_file(tmp_path / name[1])
        elif snippet.language == "python":
            compile(snippet.text, where, "exec")
            printed = run_python(snippet.text, where, names) if possible(snippet) else None
        elif snippet.language == "sh":
            printed = run_shell(snippet.text, where, tmp_path) if possible(snippet) else None
        elif snippet.word == "output" and printed is not None:
            assert snippet.text == printed, where


@pytest.mark.parametrize("page", [README, *PAGES], ids=lambda page: page.stem)
def test_every_command_that_a_page_shows_has_these_options(page: Path) -> None:
    lines = [
        line
        for snippet in snippets(page)
        for line in snippet.text.replace("\\\n", " ").splitlines()
        if line.startswith("nomad-mj ") and not re.search(r"\.\.\.|[|>&]|--help", line)
    ]
    for line in lines:
        words = shlex.split(line, comments=True)[1:]
        assert type(parse(COMMANDS, "", words)) is pkgutil.resolve_name(COMMANDS[words[0]])
    assert lines or page != README


def anchors(page: Path) -> set[str]:
    """Return what links to a page may end in: its headings, as they are made anchors of."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {
        re.sub(r"[^\w -]", "", heading).strip().lower().replace(" ", "-") for heading in headings
    }


@pytest.mark.parametrize("page", [README, *PAGES], ids=lambda page: page.stem)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for link in re.findall(r"\]\(([^):]+)\)", text):
        name, _, anchor = link.partition("#")
        target = page.parent / name if name else page
        assert target.exists(), f"{page.name}: {link}"
        assert not anchor or anchor in anchors(target), f"{page.name}: {link}"


def test_files_that_are_named_exist() -> None:
    root = DOCS.parent
    for page in PAGES:
        for name in re.findall(r"`((?:nomad_mj|models|tests)/[\w./-]+)`", page.read_text()):
            assert (root / name).exists(), f"{page.name}: {name}"
        for name in re.findall(r"`(nomad_agents/[\w./-]+)`", page.read_text()):
            assert (root / "agents" / name).exists(), f"{page.name}: {name}"


ROW = re.compile(r"^\| [^|]+ \| (?P<number>[\d.]+)(?: deg)? \| `(?P<field>[\w.]+)`", re.MULTILINE)
KNOWN = {
    "FAITHFUL": FAITHFUL,
    "TUNED": TUNED,
    "MotionConfig": MotionConfig(),
    "MotorConfig": MotorConfig(),
    "SAFE_CLEARANCE": SAFE_CLEARANCE,
}


def test_the_tables_of_parameters_are_those_of_the_code() -> None:
    page = (DOCS / "algorithm.md").read_text()
    rows = list(ROW.finditer(page))
    assert len(rows) >= 17
    for row in rows:
        name, *fields = row["field"].split(".")
        value: Any = KNOWN[name]
        for field in fields:
            value = getattr(value, field)
        number = float(row["number"])
        degrees = " deg |" in row[0]
        assert float(value) == pytest.approx(number * (3.14159265 / 180 if degrees else 1)), row[0]
