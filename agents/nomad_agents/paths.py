"""Paths as users type them."""

from pathlib import Path

from nomad_mj.errors import ConfigError


def expanded(typed: str) -> Path:
    """Return a path with ``~`` replaced by the home that it stands for.

    Raises
    ------
    ConfigError
        There is no such home.
    """
    try:
        return Path(typed).expanduser()
    except RuntimeError as error:
        raise ConfigError(f"{typed!r}: {str(error).rstrip('.').lower()}") from None
