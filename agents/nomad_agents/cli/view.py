"""``nomad-mj view``."""

import math
from dataclasses import dataclass
from typing import Literal

from nomad_agents.cli.common import console, interruptible
from nomad_agents.registry import find_agent, find_config
from nomad_agents.task_options import TaskOptions
from nomad_agents.viewer import Session, has_screen, view_in_browser, view_in_window
from nomad_agents.viewer.controls import Controls
from nomad_mj._gl import require_gl
from nomad_mj.errors import ConfigError, StartError
from nomad_mj.tasks import Start

_WIDTH, _HEIGHT = 720, 540


@dataclass(frozen=True)
class View(TaskOptions):
    """Look at a robot in a room and drive it with the keyboard, in a window or a browser."""

    start: str = ""
    """Name or number of a start of the room's, or X,Y[,HEADING] in metres and degrees; by default
    one at random."""
    agent: str = ""
    """Checkpoint, .npz, or name of an agent, as of `nomad-mj list`, that drives until a key is
    pressed."""
    config: str = "faithful"
    """Parameters of an agent given by name, faithful or tuned; a checkpoint has its own."""
    seed: int = 0
    """Of the starts and of the sensors' noise."""
    on: Literal["auto", "window", "browser"] = "auto"
    """Where to show it; auto: a window where there is a screen, else a browser."""
    host: str = "127.0.0.1"
    """Address to serve browsers at; with 0.0.0.0 other machines can watch and drive."""
    port: int = 8000
    """Port to serve browsers at; 0: any that is free."""
    width: int = _WIDTH
    """Of the picture in a browser [pixels]."""
    height: int = _HEIGHT
    """Of the picture in a browser [pixels]."""

    def run(self) -> int:
        """View until the window is closed or Ctrl-C is pressed; return the exit code."""
        screen = console(json_wanted=False)
        window = self.on == "window" or (self.on == "auto" and has_screen())
        require_gl()
        if window and not has_screen():
            raise ConfigError("on 'window': there is no screen here; take browser")
        if self.seed < 0:
            raise ConfigError(f"seed {self.seed}: must be 0 or more")
        start = parse_start(self.start)

        def tell(address: str) -> None:
            screen.print(f"Open {address} in a browser; Ctrl-C ends.", soft_wrap=True)

        try:
            with self.path_finding() as env, interruptible():
                agent = None
                if self.agent:
                    agent = find_agent(self.agent, env.scene.robot.layout, find_config(self.config))
                session = Session(env, Controls(), agent, start=start, seed=self.seed)
                if window:
                    screen.print("Close the window, or press Ctrl-C here, to end.")
                    view_in_window(session)
                else:
                    view_in_browser(
                        session,
                        host=self.host,
                        port=self.port,
                        size=(self.width, self.height),
                        ready=tell,
                    )
        except KeyboardInterrupt:
            pass  # the way to end it
        return 0


def parse_start(text: str) -> Start:
    """Return the start that an option means: a name, a number, or a place in metres and degrees.

    Raises
    ------
    StartError
        A place that is not two or three finite numbers.
    """
    if "," not in text:
        return int(text) if text.isdecimal() else text or None
    try:
        x, y, *heading = (float(part) for part in text.split(","))
        if len(heading) > 1 or not all(map(math.isfinite, (x, y, *heading))):
            raise ValueError
    except ValueError:
        raise StartError(
            f"start {text!r}: must be X,Y or X,Y,HEADING in metres and degrees, such as 8,2.5,90"
        ) from None
    return x, y, *map(math.radians, heading)
