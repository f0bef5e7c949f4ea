"""Options as plain data, as a JSON file or a saved environment specification has them."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any, TypeVar, cast, get_args, get_type_hints

import cattrs

from nomad_mj.envs import PathFindingConfig
from nomad_mj.errors import ConfigError, NomadError
from nomad_mj.movers import MovingGoal, MovingObstacles, Walkers
from nomad_mj.tasks import MotorConfig

_T = TypeVar("_T")
_TYPES: dict[str, Any] = {
    "moving_goal": MovingGoal,
    "moving_obstacles": MovingObstacles | Walkers,
    **get_type_hints(MotorConfig),
    **get_type_hints(PathFindingConfig),
}
_CONVERTER = cattrs.Converter(forbid_extra_keys=True)


def structure(what: str, given: _T | Mapping[str, Any], cls: type[_T]) -> _T:
    """Return an option of a class, made from its fields if it is given as a mapping.

    Raises
    ------
    ConfigError
        Fields that the class does not have, or values that it does not take.
    """
    if isinstance(given, cls):
        return given
    if not isinstance(given, Mapping):
        raise ConfigError(f"{what}: must be a {cls.__name__}, or a mapping of its fields")
    try:
        return _CONVERTER.structure(cast(Mapping[str, Any], given), cls)
    except Exception as error:
        for cause in _causes(error):
            if isinstance(cause, NomadError):  # the class itself has refused the values
                raise cause from None
        reason = "; ".join(cattrs.transform_error(error, path=what))
        raise ConfigError(f"{what}: is no {cls.__name__}: {' '.join(reason.split())}") from None


def _causes(error: BaseException) -> Iterator[BaseException]:
    """Yield an error and those that it groups."""
    yield error
    inner: Iterable[BaseException] = getattr(error, "exceptions", ())
    for each in inner:
        yield from _causes(each)


def task_options(given: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return the ``task_kwargs`` of `nomad_mj.load`, those given as mappings made what they are."""
    options = dict(given or {})
    for name, value in options.items():
        kind = _TYPES.get(name)
        known: list[Any] = [cls for cls in (kind, *get_args(kind)) if is_dataclass(cls)]
        if isinstance(value, Mapping) and known:
            cls = next((cls for cls in known if _has_fields(cls, value)), known[0])
            options[name] = structure(f"task option {name!r}", value, cls)
    return options


def _has_fields(cls: Any, value: Mapping[str, Any]) -> bool:
    return set(value) <= {field.name for field in fields(cls)}
