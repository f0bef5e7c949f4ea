"""Videos of experiments: short, filmed once, and honest about what they show."""

import json
import os
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
from nomad_agents.baselines import Straight
from nomad_agents.experiments import showreel
from nomad_agents.experiments.experiment import LEARNER, Experiment, Showcase, Study, Verdict
from nomad_agents.experiments.report import NoVideo, Video
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.reactive_planner.config import FAITHFUL
from nomad_agents.studies.runs import Result, Run
from PIL import Image

import nomad_mj
from nomad_mj.errors import RenderError

STUDY = Study("faithful", "empty_room", "nomad200", 1)
STARTS = [(2.0, 2.0), (4.0, 6.0)]


class Crossing(Experiment):
    """Straight to the goal through an empty room, or learning in it."""

    name, title, claim, source, table = "crossing", "Straight across", "", "", ()

    def __init__(self, *, learning: bool = False) -> None:
        self.learning = learning
        self.shown: list[Showcase] = []

    def runs(self, study: Study) -> list[Run]:
        return [Run(self.name, "", LEARNER, study.config, study.room, study.robot, 0)]

    def work(self, run: Run, folder: Path) -> Result:
        return Result(run, {})

    def judge(self, results: Sequence[Result]) -> Verdict:
        return Verdict("holds", "")

    def showcase(self, study: Study, folder: Path) -> Showcase:
        env = nomad_mj.load("path_finding", room=study.room, robot=study.robot)
        kind = ReactivePlanner if self.learning else Straight
        agent = kind(env.scene.robot.layout, FAITHFUL)
        self.shown.append(Showcase(env, agent, list(STARTS), self.learning, "nothing in the way"))
        return self.shown[-1]


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(showreel, "SIZE", (160, 120))
    monkeypatch.setattr(showreel, "FPS", 5.0)


def probe(path: Path) -> str:
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "null", "-"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stderr


@pytest.mark.gl
def test_it_lasts_as_long_as_it_may_and_has_a_poster(tmp_path: Path) -> None:
    experiment, path = Crossing(), tmp_path / "videos" / "crossing.mp4"
    shown = showreel.film(experiment, STUDY, tmp_path, path, longest=3.0)
    assert isinstance(shown, Video)
    assert (shown.path, shown.poster) == (path, path.with_suffix(".jpg"))
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
    assert frames and frames >= 10 and seconds and 2.0 < seconds < 3.4
    assert "h264" in probe(path) and "yuv420p" in probe(path)
    with Image.open(path.with_suffix(".jpg")) as poster:
        assert poster.format == "JPEG" and poster.size == (160, 120)
        assert np.asarray(poster).std() > 10
    assert shown.caption.startswith("Nothing in the way. The straight")
    assert "2 of 2 episodes" in shown.caption and "times real time" in shown.caption


def test_it_is_filmed_again_only_for_other_or_newer_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    experiment, path = Crossing(), tmp_path / "v.mp4"

    def shoot(showcase: Showcase, title: str, path: Path, longest: float) -> str:
        assert not path.with_suffix(".json").exists()
        path.touch()
        path.with_suffix(".jpg").touch()
        return title

    monkeypatch.setattr(showreel, "_shoot", shoot)

    def film(study: Study = STUDY) -> int:
        shown = showreel.film(experiment, study, tmp_path, path)
        assert isinstance(shown, Video) and shown.caption == experiment.title
        assert json.loads(path.with_suffix(".json").read_text())
        return len(experiment.shown)

    result = tmp_path / experiment.runs(STUDY)[0].file_name
    result.touch()
    assert [film(), film()] == [1, 1]
    later = path.stat().st_mtime + 10
    os.utime(result, (later, later))
    assert film() == 2
    os.utime(result, (0, 0))
    assert [film(), film()] == [2, 2]
    path.with_suffix(".jpg").unlink()
    assert film() == 3
    path.with_suffix(".json").write_text("{")
    assert film() == 4
    assert [film(Study("tuned", "empty_room", "nomad200", 1)), film()] == [5, 6]


@pytest.mark.gl
def test_the_film_shows_what_was_rehearsed_while_the_agent_learns(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    takes: list[Any] = []
    rehearse, record = showreel._rehearse, showreel.record  # pyright: ignore[reportPrivateUsage]

    def listen(showcase: Showcase) -> Any:
        takes.append(rehearse(showcase))
        assert len(showcase.agent.network.value) == 0  # type: ignore[attr-defined]
        return takes[-1]

    def keep(*args: Any, **options: Any) -> Any:
        done = record(*args, **options)
        takes.append(list(done.episodes))
        return done

    monkeypatch.setattr(showreel, "_rehearse", listen)
    monkeypatch.setattr(showreel, "record", keep)
    experiment = Crossing(learning=True)
    shown = showreel.film(experiment, STUDY, tmp_path, tmp_path / "v.mp4", longest=1.0)
    assert takes[0] == takes[1]
    assert isinstance(shown, Video) and "while it learns" in shown.caption
    agent = experiment.shown[0].agent
    assert isinstance(agent, ReactivePlanner) and len(agent.network.value) > 0


def test_without_opengl_there_is_a_reason_instead(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*args: Any, **options: Any) -> Any:
        raise RenderError("no OpenGL works here")

    monkeypatch.setattr(showreel, "record", fail)
    shown = showreel.film(Crossing(), STUDY, tmp_path, tmp_path / "v.mp4")
    assert shown == NoVideo("no OpenGL works here") and list(tmp_path.iterdir()) == []
