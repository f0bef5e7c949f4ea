"""A robot whose sensors read no less than some distance stops before it gets that near."""

from pathlib import Path

import mujoco

import nomad_mj
from nomad_mj.assets import list_robots
from nomad_mj.motion import Outcome


def test_a_robot_with_sonar_alone_still_stops_before_it_bumps(tmp_path: Path) -> None:
    spec = mujoco.MjSpec.from_file(str(list_robots()["nomad200"]))
    for sensor in [s for s in spec.sensors if s.name.startswith("infrared")]:
        spec.delete(sensor)
    robot = tmp_path / "sonar_only.xml"
    robot.write_text(spec.to_xml())
    with nomad_mj.load("path_finding", robot=str(robot), task_kwargs={"random": 0}) as env:
        assert [ring.name for ring in env.scene.robot.layout.rings] == ["sonar"]
        env.reset(start=(5.0, 3.4))  # the goal lies behind the obstacle
        outcomes = [int(env.step((1.0, 0.0)).observation["outcome"]) for _ in range(4)]
    assert Outcome.VIRTUAL_COLLISION in outcomes
    assert Outcome.BUMPED not in outcomes
