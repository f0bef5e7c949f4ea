"""Whether the optional packages of the deep learners are there."""

from importlib.util import find_spec

from nomad_mj.errors import ConfigError

NEEDED = ("torch", "stable_baselines3")
INSTALL = (
    "pip install 'nomad-mj[deep]' --extra-index-url https://download.pytorch.org/whl/cpu "
    "(PyTorch for the CPU is enough)"
)


def require_extra(*more: str) -> None:
    """Raise ConfigError, with what to do, if PyTorch, Stable-Baselines3 or `more` are missing."""
    missing = [name for name in (*NEEDED, *more) if find_spec(name) is None]
    if missing:
        raise ConfigError(f"deep learners need {' and '.join(missing)}: {INSTALL}")
