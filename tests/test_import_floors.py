"""Imports go downward only, and an agent's core never meets the physics engine."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
# A module may import what lies on a lower floor, and its own package.
FLOORS = (
    ("types", "errors"),
    ("option_types",),
    ("geometry", "limits", "_gl_probe"),
    ("perception", "motion", "_gl"),
    ("values", "guard"),
    ("assets", "robots", "arenas"),
    ("movers", "rooms", "reading"),
    ("scene",),
    ("tasks",),
    ("envs",),
    ("video", "batch"),
    ("gym",),
)
AGENT_FLOORS = (
    ("agent", "extras", "paths", "task_options"),
    ("reactive_planner", "episode", "collecting", "viewer"),
    ("baselines", "checkpoint", "training", "recording", "dataset"),
    ("evaluation", "curves", "speed"),
    ("deep",),
    ("registry",),
    ("studies",),
    ("learners", "experiments", "checks"),
    ("benchmark", "sweeps"),
    ("cli",),
)
PURE = {part for parts in FLOORS[:4] for part in parts if not part.startswith("_")}
CORE = ("agent", "reactive_planner", "baselines")
# The rest of `deep` trains, with PyTorch.
DEEP_CORE = {f"deep/{name}.py" for name in ("__init__", "agent", "policy", "settings")}
LIBRARY = sorted((ROOT / "nomad_mj").rglob("*.py"))
AGENTS = sorted((ROOT / "agents" / "nomad_agents").rglob("*.py"))


def imports(path: Path) -> Iterator[str]:
    """Yield the dotted name of every module that a file imports, inside functions too."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0 and node.module, f"{path}: relative import"
            if node.module in ("nomad_mj", "nomad_agents"):
                yield from (f"{node.module}.{alias.name}" for alias in node.names)
            else:
                yield node.module


def deep_core(module: str) -> bool:
    """Return whether a module is of those of `deep` that drive without PyTorch."""
    return f"{module.removeprefix('nomad_agents.').replace('.', '/')}.py" in DEEP_CORE


def part_of(path: Path, top: Path) -> str:
    """Return the part of a package that a file belongs to: its module or subpackage."""
    return path.relative_to(top).parts[0].removesuffix(".py")


def refuse_upward(path: Path, top: Path, floors: tuple[tuple[str, ...], ...]) -> None:
    """Fail where a file imports of its own package what lies on its floor or above."""
    floor = {part: number for number, parts in enumerate(floors) for part in parts}
    own = part_of(path, top)
    for module in imports(path):
        package, _, rest = module.partition(".")
        if package != top.name or own == "__init__":
            continue
        imported = rest.partition(".")[0]
        assert imported in floor, f"{path}: {module} is on no floor"
        below = imported == own or floor[imported] < floor[own]
        assert below, f"{path}: {own} must not import {module}"


def test_the_library_imports_downward_only_and_knows_no_agent() -> None:
    for path in LIBRARY:
        packages = {module.partition(".")[0] for module in imports(path)}
        assert "nomad_agents" not in packages, path
        refuse_upward(path, ROOT / "nomad_mj", FLOORS)


def test_agents_and_studies_import_downward_only() -> None:
    for path in AGENTS:
        refuse_upward(path, ROOT / "agents" / "nomad_agents", AGENT_FLOORS)


def test_the_lowest_floors_are_numpy_and_nothing_else() -> None:
    for path in LIBRARY:
        if part_of(path, ROOT / "nomad_mj") in PURE:
            others = {module.partition(".")[0] for module in imports(path)}
            others -= {"nomad_mj", "numpy", "typing_extensions", *sys.stdlib_module_names}
            assert not others, path


def test_the_core_of_an_agent_sees_perception_and_motion_only() -> None:
    root = ROOT / "agents" / "nomad_agents"
    for path in AGENTS:
        if part_of(path, root) in CORE or path.relative_to(root).as_posix() in DEEP_CORE:
            refuse_all_but_the_core(path)


def refuse_all_but_the_core(path: Path) -> None:
    """Fail where a file imports what an agent could not have on a robot without a simulator."""
    for module in imports(path):
        top, _, rest = module.partition(".")
        part = rest.partition(".")[0]
        if top == "nomad_mj":
            assert part in PURE, f"{path}: an agent's core must not import {module}"
        elif top == "nomad_agents":
            core = part in CORE or deep_core(module)
            assert core, f"{path}: an agent's core must not import {module}"
        else:
            assert top == "numpy" or top in sys.stdlib_module_names, f"{path}: {module}"


def test_agents_is_a_source_root_and_no_package() -> None:
    assert not (ROOT / "agents" / "__init__.py").exists()


def test_an_agent_perceives_and_decides_where_there_is_no_mujoco() -> None:
    """Run without the engine, for what the imports of imports might hide."""
    code = f"""
import importlib.abc, sys, types
class Blocked(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("mujoco", "dm_control", "dm_env", "shapely", "scipy"):
            raise ImportError("blocked: " + name)
sys.meta_path.insert(0, Blocked())
package = types.ModuleType("nomad_mj")  # its __init__ imports the whole library
package.__path__ = [{str(ROOT / "nomad_mj")!r}]
sys.modules["nomad_mj"] = package
import numpy as np
from nomad_mj.perception import SituationSpec, perceive
from nomad_mj.types import RangeRing, SensorLayout
from nomad_agents import baselines, deep, reactive_planner
from nomad_agents.reactive_planner import ReactivePlanner, ReactivePlannerConfig
layout = SensorLayout(0.2, (RangeRing("ir", tuple(np.arange(8) * np.pi / 4), 0.4, 0.0, 1.5),))
agent = ReactivePlanner(layout, ReactivePlannerConfig())
agent.start_episode()
percept = perceive(np.ones(8), 0.0, np.array([2.0, 1.0]), layout, agent.situation)
decision = agent.act(percept, np.random.default_rng(0))
assert np.abs(np.asarray(decision.action)).max() <= 1
print("decided")
"""
    ran = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT / "agents",
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.stdout == "decided\n", ran.stderr
