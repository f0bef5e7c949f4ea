"""Tries an installed nomad-mj: run by the Python it is installed in, outside the checkout.

Nothing but the package and what it requires may be needed, so there is no pytest here.
"""

import json
import subprocess
import sys
import sysconfig
from importlib.metadata import files
from pathlib import Path

from nomad_agents.experiments.report import write_report

import nomad_mj
from nomad_mj._gl import gl_report

SHIPPED = ("py.typed", "models/scene.xml", "models/robots/nomad200/nomad200.xml")


def check(holds: bool, what: str) -> None:
    """Stop where something is wrong; an assert would be gone under -O."""
    if not holds:
        sys.exit(f"smoke test: {what}")


def check_files() -> None:
    """Check that the package is the installed one, whole, and brings nothing else."""
    package = Path(nomad_mj.__file__).parent
    check(package.is_relative_to(sys.prefix), f"nomad_mj came from {package}")
    for name in SHIPPED:
        check((package / name).is_file(), f"{name} is not in the wheel")
    tops = {path.parts[0] for path in files("nomad-mj") or () if path.suffix == ".py"}
    check(tops == {"nomad_mj", "nomad_agents"}, f"the wheel installs {sorted(tops)}")


def check_environment() -> None:
    """Take one decision from Python."""
    env = nomad_mj.load("path_finding", room="paper_room", task_kwargs={"random": 0})
    env.reset()
    spec = env.action_spec()
    check(env.step(spec.generate_value()).observation is not None, "no observation")
    env.close()


def check_report(page: Path) -> None:
    """Write a report: its templates are files that are no Python."""
    write_report(page, [])
    check("</html>" in page.read_text(encoding="utf-8"), f"{page} is no whole page")


def nomad(*arguments: str) -> str:
    """Run the console script and return what it prints."""
    script = Path(sysconfig.get_path("scripts")) / "nomad-mj"
    done = subprocess.run(
        [str(script), *arguments], capture_output=True, text=True, timeout=300, check=False
    )
    said = f"nomad-mj {' '.join(arguments)} ended with {done.returncode}: {done.stderr}"
    check(done.returncode == 0, said)
    check("Exception ignored" not in done.stderr, said)
    return done.stdout


def check_commands(folder: Path) -> None:
    """Train a few decisions, and draw one frame where OpenGL works."""
    train = ("--room", "paper_room", "--agent", "reactive_planner", "--seed", "0")
    out = nomad("train", *train, "--max-decisions", "20", "--out", str(folder / "run"), "--json")
    result = json.loads(out.splitlines()[-1])
    check(result["reactions"] + result["plannings"] > 0, "no decision was taken")
    if not gl_report().works:
        print(f"no frame was drawn: {gl_report().message}")
        return
    clip = folder / "clip.mp4"
    record = ("--agent", "straight", "--room", "paper_room", "--out", str(clip))
    nomad("record", *record, "--max-decisions", "1")
    check(clip.stat().st_size > 1000, f"{clip} is empty")


if __name__ == "__main__":
    check_files()
    check_environment()
    check_report(Path.cwd() / "report.html")
    check_commands(Path.cwd())
    print(f"the wheel works: nomad-mj {nomad_mj.__version__}, {gl_report().message}")
