"""Entry point of ``nomad-mj``."""

import os
import sys
from collections.abc import Sequence
from typing import Any

from nomad_agents.cli.bench import Bench
from nomad_agents.cli.benchmark import Benchmark
from nomad_agents.cli.check import Check
from nomad_agents.cli.common import fail
from nomad_agents.cli.demo import Demo
from nomad_agents.cli.evaluate import Evaluate
from nomad_agents.cli.export import Export
from nomad_agents.cli.listing import List
from nomad_agents.cli.parsing import parse
from nomad_agents.cli.record import Record
from nomad_agents.cli.reproduce import Reproduce
from nomad_agents.cli.room import MakeRoom
from nomad_agents.cli.sweep import Sweep
from nomad_agents.cli.train import Train
from nomad_agents.cli.view import View
from nomad_mj.errors import NomadError

COMMANDS: dict[str, type[Any]] = {
    "train": Train,
    "evaluate": Evaluate,
    "record": Record,
    "export": Export,
    "view": View,
    "reproduce": Reproduce,
    "sweep": Sweep,
    "benchmark": Benchmark,
    "room": MakeRoom,
    "check": Check,
    "list": List,
    "bench": Bench,
    "demo": Demo,
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0, or 2 for a user's mistake, or 130 if interrupted."""
    typed = sys.argv[1:] if arguments is None else arguments
    try:
        command = parse(COMMANDS, "A simulated Nomad 200 learns to find its goal.", typed)
        return command.run()
    except NomadError as error:
        return fail(str(error))
    except KeyboardInterrupt:
        print("nomad-mj: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader of our output has gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1


if __name__ == "__main__":
    sys.exit(main())
