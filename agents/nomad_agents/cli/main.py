"""Entry point of ``nomad-mj``."""

import errno
import io
import os
import sys
from collections.abc import Sequence
from importlib.metadata import version

from dm_control.rl.control import PhysicsError

from nomad_agents.cli.common import fail
from nomad_agents.cli.parsing import parse
from nomad_mj.errors import NomadError

# Where each is: only the one that is typed is imported, which all together take seconds.
COMMANDS: dict[str, str] = {
    "train": "nomad_agents.cli.train:Train",
    "evaluate": "nomad_agents.cli.evaluate:Evaluate",
    "record": "nomad_agents.cli.record:Record",
    "export": "nomad_agents.cli.export:Export",
    "view": "nomad_agents.cli.view:View",
    "reproduce": "nomad_agents.cli.reproduce:Reproduce",
    "sweep": "nomad_agents.cli.sweep:Sweep",
    "benchmark": "nomad_agents.cli.benchmark:Benchmark",
    "room": "nomad_agents.cli.room:MakeRoom",
    "check": "nomad_agents.cli.check:Check",
    "list": "nomad_agents.cli.listing:List",
    "bench": "nomad_agents.cli.bench:Bench",
    "demo": "nomad_agents.cli.demo:Demo",
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0, or 2 for a user's mistake, or 130 if interrupted."""
    typed = sys.argv[1:] if arguments is None else arguments
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # of a terminal that lacks the letters
            stream.reconfigure(errors="backslashreplace")
    if list(typed) in (["--version"], ["-V"]):
        print(f"nomad-mj {version('nomad-mj')}")
        return 0
    try:
        command = parse(COMMANDS, "A simulated Nomad 200 learns to find its goal.", typed)
        return command.run()
    except NomadError as error:
        return fail(str(error))
    except PhysicsError as error:
        return fail(f"{error}; nomad-mj check ROBOT tells what may be wrong with a robot")
    except KeyboardInterrupt:
        print("nomad-mj: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader of our output has gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        if error.errno != errno.ENOSPC:
            raise
        return fail(f"cannot write: {error.strerror}")


if __name__ == "__main__":
    sys.exit(main())
