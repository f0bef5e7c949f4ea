"""How carefully a robot moves, and how a move can end."""

import math
from dataclasses import dataclass
from enum import IntEnum

from nomad_mj.errors import ConfigError
from nomad_mj.option_types import check_fields

_PATIENCE = 10.0  # [s] for a robot to come to rest that should


@dataclass(frozen=True)
class MotionConfig:
    """How carefully the robot moves.

    Attributes
    ----------
    security_distance : float
        A virtual collision is something ahead that is nearer than this [m]; path finding raises
        it to what the robot's sensors can tell.
    ahead : float
        Half the angle that counts as ahead [rad].
    beside : float
        From there to a right angle things may be nearer by this [m].
    retract : float
        How far the robot backs off after a virtual collision [m], if there is room behind it.
    braking : float
        Share of the largest deceleration that the robot counts on.
    creep : float
        Speed [m/s] down to which it slows on approach.
    time_out : float
        After this [s] a move is stopped.
    """

    security_distance: float = 0.05
    ahead: float = math.radians(75)
    beside: float = 0.02
    retract: float = 0.3
    braking: float = 0.6
    creep: float = 0.05
    time_out: float = 20.0

    def __post_init__(self) -> None:
        check_fields(self)
        for field, least, most in (
            ("security_distance", 0.0, math.inf),
            ("ahead", 0.0, math.pi),
            ("beside", 0.0, math.inf),
            ("retract", 0.0, math.inf),
            ("braking", 0.05, 1.0),
            ("creep", 0.01, math.inf),
            ("time_out", 0.1, math.inf),
        ):
            if not least <= getattr(self, field) <= most:
                raise ConfigError(
                    f"{field} {getattr(self, field)}: must be from {least:g} to {most:.4g}"
                )

    @property
    def longest(self) -> float:
        """No move takes longer than this, coming to rest included [s]."""
        return self.time_out + _PATIENCE


class Outcome(IntEnum):
    """How a move ended."""

    NONE = 0  # no move yet: the first time step of an episode
    MOVED = 1
    VIRTUAL_COLLISION = 2
    BUMPED = 3
    TIMED_OUT = 4
