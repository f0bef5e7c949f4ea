"""The errors a user can cause, each a single line that says what, where and what would be right."""

from collections.abc import Iterable


class NomadError(Exception):
    """Root of every error that a user's input can raise; the command line prints it and exits 2."""


class UnknownNameError(NomadError):
    """A name that nothing is registered under; the message lists what there is."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        super().__init__(f"unknown {kind} {name!r}; there are: {', '.join(sorted(known))}")

    def __reduce__(self) -> tuple[type[NomadError], tuple[str]]:
        """Come back from another process as the message that it is."""
        return NomadError, (str(self),)


class ModelError(NomadError):
    """A robot or room file that is missing, malformed or lacks an element."""


class StartError(NomadError):
    """A start pose inside an obstacle, outside the room or cut off from the goal."""


class ConfigError(NomadError):
    """An option whose value makes no sense."""


class CheckpointError(NomadError):
    """A checkpoint that is missing, corrupt, of another version or for other sensors."""


class OutputError(NomadError):
    """An output file or folder that cannot be written."""


class RenderError(NomadError):
    """No OpenGL implementation works here."""


class WorkerError(NomadError):
    """A process that does part of the work has gone."""
