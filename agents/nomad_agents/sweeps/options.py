"""The options that a grid can be of: those of the command line, and all parameters, by name."""

import difflib
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from typing import Any, Literal, NamedTuple, get_args, get_origin, get_type_hints

from nomad_agents.cli.task_options import TaskOptions
from nomad_agents.reactive_planner import ReactivePlannerConfig
from nomad_agents.registry import find_config
from nomad_agents.training import TrainingConfig
from nomad_mj.errors import ConfigError

Value = bool | int | float | str
AGENT, CONFIG, STARTS, DECISIONS = "agent", "config", "starts", "evaluate.max_decisions"
_TRAIN = "train."
_NOT_SWEPT = ("seed", "starts")  # of a training: --seeds, and the room's
_SCALARS = (bool, int, float, str)
_MEANT = {bool: "true or false", int: "a whole number", float: "a number"}


class Option(NamedTuple):
    """An option: its name in a grid, the part that it belongs to, its type and usual value."""

    name: str
    part: Literal["task", "run", "train", "agent"]
    kind: Any
    usual: Value


def _leaves(kind: type[Any], usual: Any, prefix: str = "") -> list[tuple[str, Any, Value]]:
    """Return (dotted name, type, usual value) of every plain field of nested dataclasses."""
    hints, found = get_type_hints(kind), list[tuple[str, Any, Value]]()
    for each in fields(kind):
        value, name = getattr(usual, each.name), f"{prefix}{each.name}"
        if is_dataclass(value):
            found += _leaves(type(value), value, f"{name}.")
        elif hints[each.name] in _SCALARS or get_origin(hints[each.name]) is Literal:
            found.append((name, hints[each.name], value))
    return found


@cache
def catalogue() -> Mapping[str, Option]:
    """Return all options by name.

    Those of the command line and the agent's parameters are called as they are there; what both
    training and evaluation have, ``max_decisions``, begins with ``train.`` or ``evaluate.``.
    """
    task = [Option(n, "task", k, v) for n, k, v in _leaves(TaskOptions, TaskOptions())]
    run = [
        Option(AGENT, "run", str, "reactive_planner"),
        Option(CONFIG, "run", str, "faithful"),
        Option(STARTS, "run", str, "50"),
        Option(DECISIONS, "run", int, 100),
    ]
    train = [
        Option(f"{_TRAIN}{n}" if n == "max_decisions" else n, "train", k, v)
        for n, k, v in _leaves(TrainingConfig, TrainingConfig())
        if n not in _NOT_SWEPT
    ]
    usual = find_config("faithful")
    agent = [Option(n, "agent", k, v) for n, k, v in _leaves(ReactivePlannerConfig, usual)]
    return {each.name: each for each in (*task, *run, *train, *agent)}


def find_option(name: str) -> Option:
    """Return the option of a name, of which dashes are underscores; ConfigError if there is none.

    The message names the likeliest ones, or lists them all.
    """
    known = catalogue()
    plain = name.strip().removeprefix("--").replace("-", "_")
    if plain in known:
        return known[plain]
    ends = [each for each in known if each.split(".")[-1] == plain.split(".")[-1]]
    close = ends or difflib.get_close_matches(plain, known, n=3)
    right = f"did you mean {' or '.join(close)}?" if close else f"there are: {', '.join(known)}"
    raise ConfigError(f"sweep: unknown option {name!r}; {right}")


def read_value(option: Option, given: Any) -> Value:
    """Return a value of an option, given as text or as YAML has it; ConfigError if it is none."""
    text = str(given).strip()
    if isinstance(given, (*_SCALARS,)):
        if option.kind is bool and text.lower() in ("true", "false"):
            return text.lower() == "true"
        if get_origin(option.kind) is Literal:
            choices = get_args(option.kind)
            if text in choices:
                return text
            raise ConfigError(f"sweep: {option.name} {text!r}: must be {' or '.join(choices)}")
        if option.kind is str:
            return text
        try:
            number = option.kind(text) if option.kind is not bool else math.nan
            if math.isfinite(number):
                return number
        except (ValueError, OverflowError):
            pass
    meant = _MEANT.get(option.kind, "a name")
    raise ConfigError(f"sweep: {option.name} {text[:60]!r}: must be {meant}")


class Settings(NamedTuple):
    """What the options of one run come to."""

    task: TaskOptions
    config: ReactivePlannerConfig
    training: TrainingConfig
    agent: str
    starts: str
    max_decisions: int


def settle(values: Mapping[str, Value], seed: int) -> Settings:
    """Return what some options come to with a seed, all others being as usual.

    Raises
    ------
    NomadError
        Values that make no sense.
    """
    known = catalogue()
    parts: dict[str, dict[str, Value]] = {part: {} for part in ("task", "run", "train", "agent")}
    for name, value in values.items():
        parts[known[name].part][name.removeprefix(_TRAIN)] = value
    run: dict[str, Any] = {
        name: parts["run"].get(name, known[name].usual)
        for name in (AGENT, CONFIG, STARTS, DECISIONS)
    }
    config = find_config(run[CONFIG])
    for name, value in parts["agent"].items():
        config = _replaced(config, name, value)
    task, train = TaskOptions(**_any(parts["task"])), TrainingConfig(seed, **_any(parts["train"]))
    return Settings(task, config, train, run[AGENT], run[STARTS], run[DECISIONS])


def _any(values: dict[str, Value]) -> dict[str, Any]:
    return {**values}


def _replaced(config: Any, name: str, value: Value) -> Any:
    """Return a configuration in which the field of a dotted name is another."""
    first, _, rest = name.partition(".")
    return replace(
        config, **{first: _replaced(getattr(config, first), rest, value) if rest else value}
    )
