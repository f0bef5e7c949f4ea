"""A deep learner's file: read for ever, refused when it is damaged, and driven without PyTorch."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import See
from nomad_agents.checkpoint import load_checkpoint, read_npz, write_npz
from nomad_agents.deep.file import load_deep, save_deep
from nomad_agents.reactive_planner import TUNED
from nomad_agents.registry import find_agent

from nomad_mj.errors import CheckpointError, ConfigError
from nomad_mj.types import RangeRing, SensorLayout

DATA = Path(__file__).parent / "data"
GOLDEN = DATA / "deep_policy_v1.npz"
Content = tuple[dict[str, Any], dict[str, Any]]


def test_the_first_file_is_still_read_and_acts_the_same(see: See) -> None:
    content = load_deep(GOLDEN)
    agent = content.agent
    assert (content.room, content.robot) == ("paper_room", "nomad200")
    assert (agent.name, agent.observation, agent.settings.hidden) == ("sac", "ranges", (8, 6))
    assert content.training["decisions"] == 60 and content.training["seed"] == 7
    assert content.conditions == {"range_noise": 0.15}
    k = np.arange(16)
    readings = [np.full(16, 6.5), np.where(k < 4, 0.4, 3.0), np.where(k % 8 < 2, 0.9, 1.7)]
    goals = [(3.0, 0.5), (-2.0, 4.0), (0.3, -5.0), (-6.0, -1.0)]
    percepts = [see(goal, ranges) for goal in goals for ranges in readings]
    then: list[list[float]] = json.loads(GOLDEN.with_suffix(".json").read_text())
    for percept, was in zip(percepts, then, strict=True):
        decision = agent.act(percept, None)
        assert decision.action == pytest.approx(was, abs=1e-6)
        assert (decision.kind, decision.action.dtype) == ("reacted", np.float64)
        assert np.array_equal(agent.act(percept, np.random.default_rng(0)).action, decision.action)


def test_what_is_saved_comes_back(tmp_path: Path) -> None:
    content = load_deep(GOLDEN)
    save_deep(tmp_path / "a.npz", content)
    again = load_deep(tmp_path / "a.npz")
    assert again[1:] == content[1:]
    assert again.agent.settings == content.agent.settings
    assert again.agent.layout == content.agent.layout
    arrays = again.agent.policy.arrays()
    for name, array in content.agent.policy.arrays().items():
        assert np.array_equal(arrays[name], array)
    metadata, _ = read_npz(tmp_path / "a.npz")
    assert {"nomad-mj", "mujoco", "numpy"} <= set(metadata["packages"])


def nan(content: Content) -> None:
    content[1]["weight_0"][0, 0] = np.nan


DAMAGES: list[tuple[str, Callable[[Content], object]]] = [
    ("is corrupt or no checkpoint: 'observation'", lambda c: c[0].pop("observation")),
    ("an observation 'smell' unknown", lambda c: c[0].update(observation="smell")),
    ("corrupt or no checkpoint: .* numbers, not", lambda c: c[0].update(observation="situation")),
    ("activation 'sine'", lambda c: c[0]["network"].update(hidden="sine")),
    ("not hold a whole SacSettings", lambda c: c[0]["settings"].update(more=1)),
    ("corrupt or no checkpoint: 'a3c'", lambda c: c[0].update(agent="a3c")),
    ("is of version 2; this program reads version 1", lambda c: c[0].update(version=2)),
    ("are not the layers of a network", lambda c: c[1].pop("bias_1")),
    ("a layer that is not finite", nan),
    ("is no checkpoint of 'nomad_mj.deep_policy'", lambda c: c[0].update(format="zip")),
]


@pytest.mark.parametrize(("told", "damage"), DAMAGES, ids=[told for told, _ in DAMAGES])
def test_a_damaged_file_is_refused_in_one_line(
    told: str, damage: Callable[[Content], object], tmp_path: Path
) -> None:
    content = read_npz(GOLDEN)
    damage(content)
    write_npz(tmp_path / "bad.npz", *content)
    with pytest.raises(CheckpointError, match=told) as caught:
        load_deep(tmp_path / "bad.npz")
    assert "\n" not in str(caught.value) and "bad.npz" in str(caught.value)


def test_each_reader_refuses_the_other_kind() -> None:
    with pytest.raises(CheckpointError, match=r"is no checkpoint of 'nomad_mj\.checkpoint'"):
        load_checkpoint(GOLDEN)
    with pytest.raises(CheckpointError, match=r"is no checkpoint of 'nomad_mj\.deep_policy'"):
        load_deep(DATA / "checkpoint_v1.npz")


def test_it_is_found_by_its_path_for_its_own_sensors_only() -> None:
    own = load_deep(GOLDEN).agent.layout
    assert find_agent(str(GOLDEN), own, TUNED).name == "sac"
    other = SensorLayout(0.2, (RangeRing("infrared", (0.0, 1.0), 0.2, 0.0, 1.5),))
    with pytest.raises(CheckpointError, match=r"is for other sensors: 16 sonar .* 2 infrared"):
        find_agent(str(GOLDEN), other, TUNED)
    with pytest.raises(ConfigError, match=r"'td3' cannot act before it is trained; .* --agent td3"):
        find_agent("td3", own, TUNED)


def test_without_the_extra_it_drives_and_training_says_what_to_install(tmp_path: Path) -> None:
    code = f"""
import sys
from importlib.machinery import PathFinder
class Without(PathFinder):
    @classmethod
    def find_spec(cls, name, *rest):
        missing = name.partition(".")[0] in ("torch", "stable_baselines3")
        return None if missing else super().find_spec(name, *rest)
sys.meta_path = [Without if finder is PathFinder else finder for finder in sys.meta_path]
from nomad_agents.cli.main import main
driven = main(["evaluate", "--agent", {str(GOLDEN)!r}, "--starts", "1", "--max-decisions", "2"])
trained = main(["train", "--agent", "sac", "--out", {str(tmp_path)!r}])
print(driven, trained)
"""
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ran.stdout.splitlines()[-1:] == ["0 2"], ran.stderr
    assert ran.stderr == (
        "nomad-mj: a deep learner needs torch (No module named 'torch'): "
        "pip install 'nomad-mj[deep]' --extra-index-url https://download.pytorch.org/whl/cpu\n"
    )
    assert list(tmp_path.iterdir()) == []
