"""A long run, made short: it counts what it does and sees what it looks for."""

import json
import mmap
from typing import Any

import mujoco
import pytest
from nomad_agents.cli.main import main
from nomad_agents.speed import soak as soaking
from nomad_agents.speed.soak import soak


@pytest.mark.parametrize("robots", [1, 4])
def test_many_episodes_neither_grow_nor_warn(robots: int) -> None:
    shares: list[float] = []
    done = soak("paper_room", 120, 0.05, robots, shares.append)
    assert done.resets == 120
    assert done.sim_hours == pytest.approx(0.05, rel=0.1)
    assert abs(done.growth) < 0.02
    assert done.warnings == 0
    assert shares[-1] == 1.0 and shares == sorted(shares)


def test_what_grows_and_warns_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    kept: list[mmap.mmap] = []
    load = soaking.nomad_mj.load

    def leaking(*args: Any, **kwargs: Any) -> Any:
        env = load(*args, **kwargs)
        reset = env.reset

        def leak() -> Any:
            kept.append(mmap.mmap(-1, 1 << 20))  # memory of the process alone, not of its heap
            kept[-1].write(b"x" * (1 << 20))
            said = mujoco.get_mju_user_warning()
            if said is not None:
                said("something is amiss")
            return reset()

        env.reset = leak
        return env

    monkeypatch.setattr(soaking.nomad_mj, "load", leaking)
    done = soak("empty_room", 60, 0.001)
    assert done.growth > 0.02 and done.warnings == 60


def test_the_command_tells_and_its_exit_code_judges(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = "bench --soak --soak-resets 100 --soak-hours 0.02 --soak-robots 4 --json"
    code = main(arguments.split())
    told = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert told["resets"] == 100 and told["warnings"] == 0
    assert code == int(told["growth"] >= 0.02)


def test_a_long_run_of_nothing_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "--soak", "--soak-hours", "0"]) == 2
    assert "--soak-hours 0.0: must be above 0" in capsys.readouterr().err
    assert main(["bench", "--soak", "--soak-resets", "64", "--soak-robots", "64"]) == 2
    assert "resets 64: must be 128 or more, two for each robot" in capsys.readouterr().err
