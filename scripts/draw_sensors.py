"""Draw what options do to the readings of the sensors, for docs/your-own-robot.md.

python scripts/draw_sensors.py docs/images/sensors.png
"""

import math
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Wedge
from nomad_agents.experiments.figures.room import Panel, rooms
from nomad_agents.studies.style import BLUE, INK, ORANGE

import nomad_mj
from nomad_mj import (
    Crosstalk,
    FiringOrder,
    Gyroscope,
    MotorEnvironment,
    OdometryNoise,
    RangeNoise,
    SonarEffects,
)
from nomad_mj.tasks.firing import Order
from nomad_mj.types import FloatArray

QUIET = RangeNoise("none")
START = (5.6, 2.2, math.pi / 2)
STRAIGHT = ((0.5, 0.0, 0.0),) * 28  # [m/s], [rad/s]: towards the box in the middle
ROUND = (((0.45, 0.3, 0.0),) * 419 + ((0.45, -0.3, 0.0),) * 419) * 2  # an eight


def crosstalk(order: Order) -> SonarEffects:
    """Return effects with which a sonar always hears what fires beside it."""
    return SonarEffects(firing=FiringOrder(4, order), crosstalk=Crosstalk(1.0))


PANELS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("as it is", {}),
    ("echoes lost, 30 degrees", {"range_noise": RangeNoise("none", grazing=math.radians(30))}),
    ("one sonar at a time, driving", {"sonar": SonarEffects(firing=FiringOrder(1))}),
    ("crosstalk: neighbours fire together", {"sonar": crosstalk("sequential")}),
    ("fired together far apart", {"sonar": crosstalk("spread")}),
)
DRIFTS = OdometryNoise(heading_per_metre=math.radians(2))


def draw_robot(axes: Axes, env: MotorEnvironment, seen: dict[str, FloatArray]) -> None:
    """Draw the robot where it is, and a wedge for what each sonar reads."""
    x, y, _ = env.physics.pose()
    layout = env.task.scene.robot.layout
    ring = layout.rings[0]
    for bearing, reading in zip(ring.bearings, seen[ring.name].tolist(), strict=True):
        low, high = np.degrees([bearing - 0.19, bearing + 0.19])
        far = layout.radius + reading
        axes.add_patch(Wedge((x, y), far, low, high, width=reading, color=BLUE, alpha=0.25, lw=0))
    axes.add_patch(Circle((x, y), layout.radius, color=INK))


def sense(options: dict[str, Any]) -> tuple[MotorEnvironment, dict[str, FloatArray]]:
    """Return a robot that has driven up to a box, and what it reads there."""
    env = nomad_mj.load("motor", task_kwargs={"range_noise": QUIET, **options})
    step = env.reset(seed=0, start=START)
    for command in STRAIGHT:
        step = env.step(command)
    return env, step.observation


def drive(options: dict[str, Any]) -> tuple[MotorEnvironment, FloatArray, FloatArray]:
    """Return the true way of a robot that drives eights, and that by odometry, (N, 2) [m] each."""
    options = {"odometry_noise": DRIFTS, "ends_at_goal": False, **options}
    env = nomad_mj.load("motor", "empty_room", task_kwargs=options)
    env.reset(seed=0, start=(5.0, 5.0, 0.6))
    true: list[tuple[float, ...]] = []
    told: list[FloatArray] = []
    for command in ROUND:
        told.append(env.step(command).observation["odometry"][:2])
        true.append(env.physics.pose()[:2])
    return env, np.array(true), np.array(told)


def main(path: Path) -> None:
    """Draw all panels."""
    seen = [(title, *sense(options)) for title, options in PANELS]
    ways = [drive({"gyroscope": gyroscope}) for gyroscope in (None, Gyroscope())]
    panels = [Panel(title, env.task.scene, (env, what)) for title, env, what in seen]
    title = "a heading that drifts, 38 m"
    panels.append(Panel(title, ways[0][0].task.scene, (ways[0][0], {})))
    signs = (
        Line2D([], [], color=BLUE, lw=6, alpha=0.4, label="sonar"),
        Line2D([], [], color=INK, label="true way"),
        Line2D([], [], color=ORANGE, label="by odometry"),
        Line2D([], [], color=BLUE, ls="--", label="with a gyroscope"),
    )
    with tempfile.TemporaryDirectory() as folder:
        base = Path(folder) / "sensors"
        with rooms(panels, base, signs, columns=3) as drawn:
            for axes, panel in drawn[:-1]:
                draw_robot(axes, *panel.content)
            axes = drawn[-1][0]
            axes.plot(*ways[0][1].T, color=INK)
            axes.plot(*ways[0][2].T, color=ORANGE)
            axes.plot(*ways[1][2].T, color=BLUE, ls="--")
        path.write_bytes(base.with_suffix(".png").read_bytes())
    for env in [env for _, env, _ in seen] + [env for env, *_ in ways]:
        env.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
