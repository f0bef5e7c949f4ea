"""``nomad-mj bench``."""

from dataclasses import dataclass, fields
from typing import NamedTuple

from rich.progress import Progress
from rich.table import Table

import nomad_mj
from nomad_agents.cli.common import console, print_json
from nomad_agents.speed.of_many import (
    async_ratio,
    batch_ratio,
    perception_ratio,
    simulated_rate,
)
from nomad_agents.speed.ratios import control_step_ratio, decision_times, training_ratio
from nomad_agents.speed.soak import Soaked, soak
from nomad_mj.envs import DEFAULT_ROOM
from nomad_mj.errors import ConfigError, RenderError
from nomad_mj.video import frame_costs


class Limit(NamedTuple):
    """What a measured number should be."""

    what: str
    number: float
    at_least: bool = False

    def __str__(self) -> str:
        return f"at {'least' if self.at_least else 'most'} {self.number:g}"


LIMITS = {
    "control_step_ratio": Limit("motor control step / bare mj_step loop, same model, rays", 1.25),
    "training_ratio": Limit("training / the same number of control steps in the bare loop", 1.6),
    "reaction_us": Limit("one reaction, perception to action, 500 exemplars, us", 300.0),
    "planning_ms": Limit("one planning, 80 actions, ms", 3.0),
    "frame_ratio": Limit("recorded frame 640 x 480 / bare mujoco.Renderer frame", 1.4),
    "batch_ratio": Limit("control steps/s of 64 robots, 2 threads / bare loop, 1", 1.5, True),
    "async_ratio": Limit("the same / gymnasium's AsyncVectorEnv, 2 processes", 2.0, True),
    "perception_ratio": Limit("4096 single perceptions / 4096 at once, 2 threads", 20.0, True),
    "simulated_rate": Limit("simulated seconds a second, one robot, all sensors", 116.0, True),
}
_FRAMES = 60
_SOAK_RESETS, _SOAK_HOURS = 10_000, 10.0
_SOAK_GROWTH = 0.02


@dataclass(frozen=True)
class Bench:
    """Measure the speed as ratios to bare MuJoCo, both in the same run."""

    room: str = DEFAULT_ROOM
    """Name of a room, or an MJCF file."""
    soak: bool = False
    """Instead run for long, and tell whether the memory grows: minutes."""
    soak_resets: int = _SOAK_RESETS
    """Episodes of the long run."""
    soak_hours: float = _SOAK_HOURS
    """Simulated time of the long run [h]."""
    soak_robots: int = 1
    """Robots of the long run: 1 for the single environment, more for a batch."""
    json: bool = False
    """Print one line of JSON last on standard output."""

    def run(self) -> int:
        """Measure; return the exit code."""
        if self.soak:
            return self._soak()
        for each in fields(self):
            if each.name.startswith("soak_") and getattr(self, each.name) != each.default:
                raise ConfigError(f"--{each.name.replace('_', '-')}: only with --soak")
        return self._speed()

    def _speed(self) -> int:
        screen = console(json_wanted=self.json)
        with screen.status("measuring"):
            reaction, planning = decision_times(self.room)
            measured: dict[str, float] = {
                "control_step_ratio": control_step_ratio(self.room),
                "training_ratio": training_ratio(self.room),
                "reaction_us": reaction * 1e6,
                "planning_ms": planning * 1e3,
                "frame_ratio": _frame_ratio(self.room),
                "batch_ratio": batch_ratio(self.room),
                "async_ratio": async_ratio(self.room),
                "perception_ratio": perception_ratio(self.room),
                "simulated_rate": simulated_rate(self.room),
            }
        table = Table("what", "measured", "should be", title="Speed")
        for key, value in measured.items():
            shown = f"{value:.3g}" if value == value else "no OpenGL"
            table.add_row(LIMITS[key].what, shown, str(LIMITS[key]))
        screen.print(table)
        if self.json:
            print_json({key: float(f"{value:.4g}") for key, value in measured.items()})
        return 0

    def _soak(self) -> int:
        """Run for long; return 1 if the memory grows or the engine warns."""
        for name, value in (
            ("resets", self.soak_resets),
            ("hours", self.soak_hours),
            ("robots", self.soak_robots),
        ):
            if not value > 0:
                raise ConfigError(f"--soak-{name} {value}: must be above 0")
        screen = console(json_wanted=self.json)
        with Progress(console=screen, transient=True) as bar:
            task = bar.add_task("driving", total=1.0)
            done = soak(
                self.room,
                self.soak_resets,
                self.soak_hours,
                self.soak_robots,
                lambda share: bar.update(task, completed=share),
            )
        table = Table("what", "measured", "should be", title="A long run in one process")
        table.add_row("episodes begun", str(done.resets), "")
        table.add_row("simulated hours", f"{done.sim_hours:.3g}", "")
        table.add_row("growth of the memory", f"{done.growth:.2%}", f"below {_SOAK_GROWTH:.0%}")
        table.add_row("warnings of the engine", str(done.warnings), "0")
        screen.print(table)
        if self.json:
            print_json(vars(done))
        return int(not _passes(done))


def _passes(done: Soaked) -> bool:
    return done.growth < _SOAK_GROWTH and done.warnings == 0


def _frame_ratio(room: str) -> float:
    """Return the cost of a recorded frame over that of a bare one, NaN without OpenGL."""
    with nomad_mj.load("path_finding", room=room, task_kwargs={"random": 0}) as env:
        try:
            return frame_costs(env, _FRAMES).ratio
        except RenderError:
            return float("nan")
