"""From the arguments of the command line to a command, or to one line that says what is wrong."""

import contextlib
import difflib
import io
import operator
import pkgutil
import re
from collections.abc import Mapping, Sequence
from dataclasses import fields
from functools import reduce
from typing import Annotated, Any, get_type_hints

import tyro

from nomad_mj.errors import ConfigError, UnknownNameError

_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
# Upper border of a box, or lower border or rule across it, drawn with lines or, in ASCII, dashes.
_FRAME = re.compile("\u256d.*|[-\u2500\u2502\u2570\u256f ]{3,}")
_SIDE = "\u2502"
_NUMBERS = {"INT": "a whole number", "FLOAT": "a number"}


def parse(commands: Mapping[str, str], about: str, arguments: Sequence[str]) -> Any:
    """Return the command that the arguments ask for, with its options.

    Parameters
    ----------
    commands : mapping of str to str
        The commands by name: ``module:class`` of a dataclass.
    about : str
        What the program is, for its help.
    arguments : sequence of str
        As typed, without the program's name.

    Raises
    ------
    UnknownNameError
        A command that there is not.
    ConfigError
        No command, an option that there is not, or a value of the wrong type.
    SystemExit
        With 0, after the help that was asked for.
    """
    first = arguments[0] if arguments else ""
    asks = first in ("-h", "--help") or first.startswith("--tyro-")
    if not asks and (not first or first.startswith("-")):
        raise ConfigError(f"the command must come first, one of: {', '.join(commands)}")
    if not asks and first not in commands:
        raise UnknownNameError("command", first, commands)
    wanted = commands if asks else {first: commands[first]}
    known = {name: pkgutil.resolve_name(where) for name, where in wanted.items()}
    shown = (Annotated[cls, tyro.conf.subcommand(name)] for name, cls in known.items())
    union: Any = reduce(operator.or_, shown) if asks else known[first]
    complaint = io.StringIO()
    try:
        with contextlib.redirect_stderr(complaint):
            command, unknown = tyro.cli(
                union,
                prog="nomad-mj" if asks else f"nomad-mj {first}",
                description=about if asks else None,
                args=arguments if asks else arguments[1:],
                return_unknown_args=True,
                config=(tyro.conf.FlagCreatePairsOff,),
            )
    except SystemExit as end:
        if not end.code:
            raise
        raise ConfigError(f"{first}: {_one_line(complaint.getvalue())}") from None
    if unknown:
        raise _unknown_argument(first, known[first], unknown[0])
    return command


def _unknown_argument(name: str, command: type[Any], given: str) -> ConfigError:
    """Return the error of an argument that a command does not take."""
    hints = get_type_hints(command, include_extras=True)
    options = [
        f"--{each.name.replace('_', '-')}"
        for each in fields(command)
        if tyro.conf.Positional not in getattr(hints[each.name], "__metadata__", ())
    ]
    if not given.startswith("-"):
        return ConfigError(f"{name}: takes no argument {given!r}; options are: {' '.join(options)}")
    close = difflib.get_close_matches(given, options, n=2)
    right = f"did you mean {' or '.join(close)}?" if close else f"there are: {' '.join(options)}"
    return ConfigError(f"{name}: unknown option {given!r}; {right}")


def _one_line(box: str) -> str:
    """Return what tyro says in a box, up to the first rule across it, as one line."""
    parts: list[list[str]] = [[]]
    for line in _COLOUR.sub("", box).splitlines():
        if _FRAME.fullmatch(line.strip()):
            parts.append([])
        else:
            parts[-1].append(line.strip(f"{_SIDE} "))
    _, said, *rest = (" ".join(" ".join(part).split()) for part in (*parts, []))
    found = re.fullmatch(r"Error parsing (\S+): (.*)", said)
    if not found:
        return said
    takes = re.search(rf"{re.escape(found[1])} (?:\{{None\}}\|)?([A-Z]+)", " ".join(rest))
    value = re.search(r": (['\"].*)", found[2])
    if not takes or takes[1] not in _NUMBERS or not value:
        return f"{found[1]}: {found[2]}"
    return f"{found[1]} {value[1]}: must be {_NUMBERS[takes[1]]}"
