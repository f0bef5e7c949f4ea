"""``nomad-mj bench``."""

from dataclasses import dataclass

from rich.table import Table

import nomad_mj
from nomad_agents.cli.common import console, print_json
from nomad_agents.experiments.speed import control_step_ratio, decision_times, training_ratio
from nomad_mj.envs import DEFAULT_ROOM
from nomad_mj.errors import RenderError
from nomad_mj.video import frame_costs

LIMITS = {
    "control_step_ratio": (1.25, "motor control step / bare mj_step loop, same model and rays"),
    "training_ratio": (1.6, "training / the same number of control steps in the bare loop"),
    "reaction_us": (300.0, "one reaction, perception to action, 500 exemplars, us"),
    "planning_ms": (3.0, "one planning, 80 actions, ms"),
    "frame_ratio": (1.4, "recorded frame 640 x 480 / bare mujoco.Renderer frame"),
}
_FRAMES = 60


@dataclass(frozen=True)
class Bench:
    """Measure the speed as ratios to bare MuJoCo, both in the same run."""

    room: str = DEFAULT_ROOM
    """Name of a room, or an MJCF file."""
    json: bool = False
    """Print one line of JSON last on standard output."""

    def run(self) -> int:
        """Measure; return the exit code."""
        screen = console(json_wanted=self.json)
        with screen.status("measuring"):
            reaction, planning = decision_times(self.room)
            measured: dict[str, float] = {
                "control_step_ratio": control_step_ratio(self.room),
                "training_ratio": training_ratio(self.room),
                "reaction_us": reaction * 1e6,
                "planning_ms": planning * 1e3,
                "frame_ratio": _frame_ratio(self.room),
            }
        table = Table("what", "measured", "at most", title="Speed")
        for key, value in measured.items():
            limit, what = LIMITS[key]
            shown = f"{value:.3g}" if value == value else "no OpenGL"
            table.add_row(what, shown, f"{limit:g}")
        screen.print(table)
        if self.json:
            print_json({key: float(f"{value:.4g}") for key, value in measured.items()})
        return 0


def _frame_ratio(room: str) -> float:
    """Return the cost of a recorded frame over that of a bare one, NaN without OpenGL."""
    with nomad_mj.load("path_finding", room=room, task_kwargs={"random": 0}) as env:
        try:
            return frame_costs(env, _FRAMES).ratio
        except RenderError:
            return float("nan")
