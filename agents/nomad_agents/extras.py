"""Libraries that come with an extra of this package, and the line that says which."""

import importlib
from typing import Any

from nomad_mj.errors import ConfigError


def need(module: str, extra: str, what: str, options: str = "") -> Any:
    """Return a module that only an extra of the package brings.

    Parameters
    ----------
    module : str
        Its dotted name.
    extra : str
        As in ``pip install 'nomad-mj[extra]'``.
    what : str
        What needs it, for the message.
    options : str
        Of pip, beside the extra.

    Raises
    ------
    ConfigError
        It is not installed.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        install = f"pip install 'nomad-mj[{extra}]' {options}".rstrip()
        raise ConfigError(f"{what} needs {module.partition('.')[0]} ({error}): {install}") from None
