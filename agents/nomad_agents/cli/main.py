"""Entry point of ``nomad-mj``."""

import os
import sys
from collections.abc import Sequence
from typing import Annotated

import tyro

from nomad_agents.cli.bench import Bench
from nomad_agents.cli.common import fail
from nomad_agents.cli.demo import Demo
from nomad_agents.cli.evaluate import Evaluate
from nomad_agents.cli.listing import List
from nomad_agents.cli.record import Record
from nomad_agents.cli.reproduce import Reproduce
from nomad_agents.cli.train import Train
from nomad_mj.errors import NomadError

Command = (
    Annotated[Train, tyro.conf.subcommand("train")]
    | Annotated[Evaluate, tyro.conf.subcommand("evaluate")]
    | Annotated[Record, tyro.conf.subcommand("record")]
    | Annotated[Reproduce, tyro.conf.subcommand("reproduce")]
    | Annotated[List, tyro.conf.subcommand("list")]
    | Annotated[Bench, tyro.conf.subcommand("bench")]
    | Annotated[Demo, tyro.conf.subcommand("demo")]
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return 0, or 2 for a user's mistake, or 130 if interrupted."""
    try:
        command: Train | Evaluate | Record | Reproduce | List | Bench | Demo = tyro.cli(
            Command,  # pyright: ignore[reportArgumentType]
            prog="nomad-mj",
            description="A simulated Nomad 200 learns to find its goal.",
            args=arguments,
            config=(tyro.conf.FlagCreatePairsOff,),
        )
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
