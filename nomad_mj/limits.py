"""The limits of options: one line of error for a number that makes no sense."""

from nomad_mj.errors import ConfigError
from nomad_mj.option_types import check_fields

TINY = 1e-9  # least value of what must be above 0
MOST = 1e9  # greatest of what must be finite


def require(config: object, **limits: tuple[float, float]) -> None:
    """Raise ConfigError for a field of a config of another type or beyond its limits.

    The limits include their ends.
    """
    check_fields(config)
    for name, (least, most) in limits.items():
        value = getattr(config, name)
        if not least <= value <= most:
            raise ConfigError(f"{name} {value}: must be from {least:g} to {most:.4g}")
