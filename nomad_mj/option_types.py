"""Options of the wrong Python type, answered in one line that names the option and the type."""

from collections.abc import Mapping
from dataclasses import fields
from functools import lru_cache
from numbers import Integral, Real
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from nomad_mj.errors import ConfigError

_WORDS = {
    float: "a number",
    int: "a whole number",
    bool: "True or False",
    type(None): "None",
}
_LIKE: dict[type, Any] = {int: Integral, float: Real, tuple: (tuple, list)}


def check_types(what: str, given: Mapping[str, Any], types: Mapping[str, Any]) -> None:
    """Raise ConfigError unless the options are of their types.

    Parameters
    ----------
    what : str
        What kind of option they are, for the message.
    given : mapping
        The options; numpy's numbers will do for Python's.
    types : mapping
        Of each option a class, or a union of classes; options that are not in it may be anything.
        A list will do for a tuple, whatever is in it, and of a Literal nothing is checked.
    """
    for name, value in given.items():
        wanted = _classes(types.get(name, object))
        if not any(_fits(value, cls) for cls in wanted):
            shown = " ".join(repr(value).split())
            shown = shown if len(shown) <= 60 else shown[:57] + "..."
            right = " or ".join(_words(cls) for cls in wanted)
            raise ConfigError(f"{what} {name!r}: must be {right}, not {shown}")


def check_fields(config: Any) -> None:
    """Raise ConfigError unless the fields of a dataclass are of the types that it says."""
    cls = type(config)
    given = {field.name: getattr(config, field.name) for field in fields(config)}
    check_types(cls.__name__, given, _hints(cls))


@lru_cache
def _hints(cls: type) -> dict[str, Any]:
    return get_type_hints(cls)


def _classes(wanted: Any) -> list[type]:
    union = get_origin(wanted) in (Union, UnionType)
    return [_plain(each) for each in (get_args(wanted) if union else (wanted,))]


def _plain(wanted: Any) -> type:
    origin = get_origin(wanted)
    if origin is None:
        return wanted
    return origin if isinstance(origin, type) else object


def _fits(value: object, cls: type) -> bool:
    if cls is bool:
        return isinstance(value, bool | np.bool_)
    if isinstance(value, bool) and cls in (int, float):
        return False
    return isinstance(value, _LIKE.get(cls, cls))


def _words(cls: type) -> str:
    article = "an" if cls.__name__[0] in "AEIOU" else "a"
    return _WORDS.get(cls, f"{article} {cls.__name__}")
