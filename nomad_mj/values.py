"""Numbers out of files that people write, and small files as text."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from nomad_mj.errors import ModelError

_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # ten times as fast, if built in
_LARGEST = 1_000_000  # bytes of a YAML file
_DEEPEST = 20  # lists in lists
_MOST_PARTS = 50_000  # values, and beginnings and ends of lists
_EXAMPLES = {"room": "image: map.pgm", "robot": "drive: differential"}


def number(value: Any, what: str, low: float = -1e6, high: float = 1e6) -> float:
    """Return a finite number within bounds; ModelError, beginning with `what`, for anything else.

    Text such as ``1e-2``, which YAML does not take for a number, is one too.
    """
    try:
        found = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        found = math.nan
    if not low <= found <= high:
        raise ModelError(f"{what} {_short(value)}: must be a number from {low:g} to {high:g}")
    return found


def numbers(
    value: Any, what: str, least: int, most: int | None = None, low: float = -1e6
) -> tuple[float, ...]:
    """Return a list of `least` to `most` (or just `least`) numbers; ModelError otherwise."""
    most = least if most is None else most
    if not isinstance(value, list) or not least <= len(value) <= most:
        count = f"{least}" if least == most else f"{least} to {most}"
        raise ModelError(f"{what} {_short(value)}: must be a list of {count} numbers")
    return tuple(number(each, what, low) for each in value)


def refuse_others(given: Mapping[Any, Any], known: tuple[str, ...], what: str) -> None:
    """Raise ModelError for a key that is not known."""
    for key in given:
        if key not in known:
            raise ModelError(f"{what} knows no {_short(key)}; there are: {', '.join(known)}")


def read_yaml(path: Path, kind: str) -> dict[Any, Any]:
    """Return the mapping that a YAML file holds; `kind` says of what it is, for messages.

    Raises
    ------
    ModelError
        It cannot be read, is no YAML, or holds something else.
    """
    what = f"{kind} file {str(path)!r}"
    try:
        if path.stat().st_size > _LARGEST:
            raise ModelError(f"{what} is larger than {_LARGEST // 1_000_000} MB; is it YAML?")
        text = path.read_text(encoding="utf-8")
        _check_parts(text)
        held = yaml.load(text, Loader=_LOADER)
    except OSError as error:
        raise ModelError(f"{what} cannot be read: {error.strerror}") from None
    except (yaml.YAMLError, ValueError, LookupError, TypeError, AttributeError) as error:
        # Beside its own errors the parser lets out those of Python's that odd values bring.
        reason = " ".join(str(error).split())
        raise ModelError(f"{what} is not valid YAML: {reason[:200]}") from None
    if not isinstance(held, dict):
        raise ModelError(
            f"{what} must hold keys and values, such as {_EXAMPLES.get(kind, 'name: 1')}"
        )
    return held


def _check_parts(text: str) -> None:
    """Raise ValueError for YAML that would take for ever, before anything is made of it."""
    depth = 0
    for count, event in enumerate(yaml.parse(text, Loader=_LOADER)):
        if isinstance(event, yaml.AliasEvent):  # nine lines of them can stand for a milliard values
            raise ValueError(f"*{event.anchor} stands for something else; write that out")
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if depth > _DEEPEST or count > _MOST_PARTS:
            raise ValueError(f"more than {_DEEPEST} levels or {_MOST_PARTS} parts")


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
