"""Agents on video."""

from pathlib import Path
from typing import Any

import imageio_ffmpeg
import pytest
from nomad_agents.agent import Decision
from nomad_agents.baselines import Planner, Straight
from nomad_agents.reactive_planner.config import FAITHFUL
from nomad_agents.recording import record

import nomad_mj
from nomad_mj.errors import StartError
from nomad_mj.perception import Percept
from nomad_mj.video import BLUE, ORANGE, Caption, EpisodeRecorder

pytestmark = pytest.mark.gl
SMALL = (160, 120)


def test_episodes_from_several_starts_make_one_video(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    captions: list[Caption] = []
    annotate = EpisodeRecorder.annotate

    def listen(self: EpisodeRecorder, *args: Any, **options: Any) -> None:
        captions.append(args[2])
        annotate(self, *args, **options)

    monkeypatch.setattr(EpisodeRecorder, "annotate", listen)
    env = nomad_mj.load("path_finding", room="paper_room")
    agent = Planner(env.scene.robot.layout, FAITHFUL)
    path = tmp_path / "v.mp4"
    done = record(env, agent, path, starts=[3, 8], view="chase", speed=10.0, size=SMALL)
    env.close()
    assert done.path == path and [episode.reached for episode in done.episodes] == [True, True]
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
    assert frames == done.frames and seconds == pytest.approx(done.seconds, abs=0.1)
    driven = sum(episode.duration for episode in done.episodes) / 10.0
    assert seconds == pytest.approx(driven + 2 * (1.2 + 1.6), abs=0.2)
    assert len(captions) == sum(episode.decisions for episode in done.episodes)
    assert {(c.badge, c.colour) for c in captions} == {("planned", ORANGE)}
    assert captions[0].fields == (("decision", "1"),)
    assert captions[1].fields[0] == ("decision", "2") and captions[1].fields[1][0] == "last z"


def test_reactions_and_agents_that_know_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    env = nomad_mj.load("path_finding", room="empty_room")
    agent = Straight(env.scene.robot.layout, FAITHFUL)
    starts = [(5.0, 5.0)]
    seen: list[Caption] = []
    caption = EpisodeRecorder.caption

    def listen(self: EpisodeRecorder, text: Caption) -> None:
        seen.append(text)
        caption(self, text)

    monkeypatch.setattr(EpisodeRecorder, "caption", listen)
    record(env, agent, tmp_path / "a.mp4", starts=starts, speed=20.0, size=SMALL, max_decisions=1)
    assert [(c.badge, c.colour) for c in seen] == [("reacted", BLUE)]

    def shrug(percept: Percept, explore: Any) -> Decision:
        return Decision(percept.goal, "none", unmatched=True)

    monkeypatch.setattr(agent, "act", shrug)
    done = record(env, agent, tmp_path / "b.mp4", starts=starts, view="top", size=SMALL)
    env.close()
    assert done.episodes[0].decisions == 0 and done.frames == round(1.6 * 30)


def test_a_bad_start_leaves_no_video(tmp_path: Path) -> None:
    env = nomad_mj.load("path_finding", room="paper_room")
    agent = Straight(env.scene.robot.layout, FAITHFUL)
    with pytest.raises(StartError):
        record(env, agent, tmp_path / "v.mp4", starts=[3, 99], speed=50.0, size=SMALL)
    env.close()
    assert list(tmp_path.iterdir()) == []
