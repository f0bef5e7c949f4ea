"""The options that a grid can be of: those of the command line, and all parameters, by name."""

import difflib
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, Literal, NamedTuple, get_args, get_origin, get_type_hints

from nomad_agents.baselines import Planner, RandomMoves, Straight
from nomad_agents.deep import LEARNERS as DEEP
from nomad_agents.learners import LEARNERS
from nomad_agents.reactive_planner import ReactivePlanner, ReactivePlannerConfig
from nomad_agents.registry import AGENTS, SETTINGS, find_config
from nomad_agents.task_options import TaskOptions
from nomad_agents.training import TrainingConfig
from nomad_mj.errors import ConfigError
from nomad_mj.perception import OBSERVATIONS, Observation

Value = bool | int | float | str
AGENT, CONFIG, STARTS, MAX_DECISIONS = "agent", "config", "starts", "evaluate.max_decisions"
OBSERVATION, DECISIONS = "observation", "decisions"
TRAIN = "train."
USUAL_AGENT = ReactivePlanner.name
# Of a training: --seeds, the room's, and what changes no number.
_NOT_SWEPT = ("seed", "starts", "whole_tests")
_MOST = 2**63  # a whole number of a table
_SCALARS = (bool, int, float, str)
_SIZES = tuple[int, ...]
_MEANT = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    _SIZES: "whole numbers such as 64,64",
}
_BLIND = (Straight.name, RandomMoves.name)  # no configuration changes what they do


class Option(NamedTuple):
    """An option of a grid.

    Attributes
    ----------
    name : str
        In a grid.
    part : str
        Where it belongs: to the task, the run as a whole, the training of the reactive planner, the
        configuration, or an agent's own settings.
    kind : type
        Of its values; tuples of numbers are text in a grid.
    usual : Value
        What holds where it is not given.
    agents : tuple of str
        Who has it; everyone if empty, checkpoints too.
    """

    name: str
    part: Literal["task", "run", "train", "config", "own"]
    kind: Any
    usual: Value
    agents: tuple[str, ...] = ()

    def is_of(self, agent: Value) -> bool:
        """Return whether an agent has it."""
        return not self.agents or agent in self.agents


def _leaves(kind: type[Any], usual: Any, prefix: str = "") -> list[tuple[str, Any, Value]]:
    """Return (dotted name, type, usual value) of every plain field of nested dataclasses."""
    hints, found = get_type_hints(kind), list[tuple[str, Any, Value]]()
    for each in fields(kind):
        value, name = getattr(usual, each.name), f"{prefix}{each.name}"
        if is_dataclass(value):
            found += _leaves(type(value), value, f"{name}.")
        elif hints[each.name] in _SCALARS or get_origin(hints[each.name]) is Literal:
            found.append((name, hints[each.name], value))
        elif hints[each.name] == _SIZES:
            found.append((name, _SIZES, ",".join(map(str, value))))
    return found


@cache
def catalogue() -> Mapping[str, Option]:
    """Return all options by name.

    Those of the command line and the parameters of a configuration are called as they are there;
    what both training and evaluation have, ``max_decisions``, begins with ``train.`` or
    ``evaluate.``, and what only one agent is told with its name, ``sac.`` or ``vfh.``.
    """
    task = [Option(n, "task", k, v) for n, k, v in _leaves(TaskOptions, TaskOptions())]
    train = [
        Option(f"{TRAIN}{n}" if n == "max_decisions" else n, "train", k, v, (USUAL_AGENT,))
        for n, k, v in _leaves(TrainingConfig, TrainingConfig())
        if n not in _NOT_SWEPT
    ]
    usual = find_config("faithful")
    config = [
        Option(n, "config", k, v, _who_reads(n))
        for n, k, v in _leaves(ReactivePlannerConfig, usual)
        if not n.startswith("action.")  # the environment has its own idea of how long a move is
    ]
    settings = {**SETTINGS, **{name: made() for name, made in DEEP.items()}}
    own = [
        Option(n, "own", k, v, (agent,))
        for agent, value in settings.items()
        for n, k, v in _leaves(type(value), value, f"{agent}.")
    ]
    return {each.name: each for each in (*task, *_of_runs(), *train, *config, *own)}


def _of_runs() -> list[Option]:
    """Return what is neither of the task nor a parameter."""
    by_budget = tuple(n for n, each in LEARNERS.items() if each.learns and n != USUAL_AGENT)
    return [
        Option(AGENT, "run", str, USUAL_AGENT),
        Option(CONFIG, "run", str, "faithful", _who_reads("situation.")),
        Option(STARTS, "run", str, "50"),
        Option(MAX_DECISIONS, "run", int, 100),
        Option(OBSERVATION, "run", Observation, OBSERVATIONS[0], tuple(DEEP)),
        Option(DECISIONS, "run", int, 10_000, by_budget),
    ]


def _who_reads(name: str) -> tuple[str, ...]:
    """Return the agents that a field of the configuration makes a difference to."""
    part = name.partition(".")[0]
    if part == "situation":
        return tuple(agent for agent in AGENTS if agent not in _BLIND)
    return (USUAL_AGENT, Planner.name) if part == "planner" else (USUAL_AGENT,)


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
    if option.kind == _SIZES and isinstance(given, list):
        given = ",".join(map(str, given))  # pyright: ignore[reportUnknownArgumentType]
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
            if option.kind == _SIZES:
                return ",".join(str(size) for size in sizes(text))
            number = option.kind(text) if option.kind is not bool else math.nan
            if math.isfinite(number) and (option.kind is not int or abs(number) < _MOST):
                return number
        except (ValueError, OverflowError):
            pass
    meant = _MEANT.get(option.kind, "a name")
    raise ConfigError(f"sweep: {option.name} {text[:60]!r}: must be {meant}")


def sizes(text: str) -> tuple[int, ...]:
    """Return the whole numbers of a text such as ``64,64``; ValueError if it is none."""
    return tuple(int(part) for part in text.split(","))
