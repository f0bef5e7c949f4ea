"""Options of the wrong Python type, answered in one line that names the option and the type."""

from collections.abc import Mapping
from numbers import Integral, Real
from types import UnionType
from typing import Any, Union, get_args, get_origin

import numpy as np

from nomad_mj.errors import ConfigError

_WORDS = {
    float: "a number",
    int: "a whole number",
    bool: "True or False",
    type(None): "None",
}


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
    """
    for name, value in given.items():
        wanted = _classes(types.get(name, object))
        if not any(_fits(value, cls) for cls in wanted):
            shown = " ".join(repr(value).split())
            shown = shown if len(shown) <= 60 else shown[:57] + "..."
            right = " or ".join(_words(cls) for cls in wanted)
            raise ConfigError(f"{what} {name!r}: must be {right}, not {shown}")


def _classes(wanted: Any) -> tuple[type, ...]:
    return get_args(wanted) if get_origin(wanted) in (Union, UnionType) else (wanted,)


def _fits(value: object, cls: type) -> bool:
    if cls is bool:
        return isinstance(value, bool | np.bool_)
    if isinstance(value, bool) and cls in (int, float):
        return False
    return isinstance(value, {int: Integral, float: Real}.get(cls, cls))


def _words(cls: type) -> str:
    article = "an" if cls.__name__[0] in "AEIOU" else "a"
    return _WORDS.get(cls, f"{article} {cls.__name__}")
