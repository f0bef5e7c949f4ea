"""A checkpoint of version 1 loads and acts the same, whatever becomes of the program."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import See
from nomad_agents.checkpoint import load_checkpoint
from nomad_agents.training import Training

from nomad_mj.perception import Percept
from nomad_mj.types import FloatArray

DATA = Path(__file__).parent / "data"
GOLDEN = DATA / "checkpoint_v1.npz"


def percepts(see: See, known: FloatArray) -> list[Percept]:
    """Return percepts of goals all around, in the open and before walls, and known ones (n, 26)."""
    k = np.arange(16)
    readings = [np.full(16, 6.5), np.where(k < 4, 0.4, 3.0), np.where(k % 8 < 2, 0.9, 1.7)]
    goals = [(3.0, 0.5), (-2.0, 4.0), (0.3, -5.0), (-6.0, -1.0)]
    seen = [see(goal, ranges) for goal in goals for ranges in readings]
    return seen + [seen[0]._replace(situation=situation) for situation in known]


def test_the_first_checkpoint_is_still_read() -> None:
    checkpoint = load_checkpoint(GOLDEN)
    assert (checkpoint.room, checkpoint.robot) == ("paper_room", "nomad200")
    assert checkpoint.agent.config.k_ind == 0.1 and checkpoint.agent.config.no_match == "plan"
    assert checkpoint.training["seed"] == 7 and checkpoint.training["decisions"] == 40
    assert set(checkpoint.training) == {*vars(Training()), "seed"}
    network = checkpoint.agent.network
    assert checkpoint.agent.plannings == checkpoint.training["plannings"] > 0
    assert len(network.category) >= len(network.value) > 0
    assert [ring.name for ring in checkpoint.layout.rings] == ["sonar", "infrared"]


def test_the_first_checkpoint_still_acts_the_same(see: See) -> None:
    agent = load_checkpoint(GOLDEN).agent
    then: list[dict[str, Any]] = json.loads((DATA / "checkpoint_v1.json").read_text())
    now = [agent.act(percept, None) for percept in percepts(see, agent.network.situation)]
    assert len(now) == len(then)
    assert {"reacted", "planned"} == {was["kind"] for was in then}
    for was, decision in zip(then, now, strict=True):
        assert (decision.kind, decision.category) == (was["kind"], was["category"])
        assert decision.action == pytest.approx(was["action"], abs=1e-9)
