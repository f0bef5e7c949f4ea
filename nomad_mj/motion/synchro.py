"""Synchro drive: all wheels are rolled by one motor and steered by another; the base never turns.

A third motor turns the turret with the range sensors, if there is one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from nomad_mj.motion.config import MotionConfig
from nomad_mj.motion.drive import Move
from nomad_mj.motion.straight import StraightMove
from nomad_mj.types import MotionLimits, Travel

_TURRET_GAIN = 4.0  # [1/s] with which the turret holds its direction


@dataclass(frozen=True)
class SynchroDrive:
    """The drive of the Nomad 200: see `Drive`.

    Attributes
    ----------
    limits : MotionLimits
        Of translation and of steering.
    turret : bool
        Whether the range sensors sit on a turret; else they keep their direction.
    """

    limits: MotionLimits
    turret: bool = True
    kind = "synchro"

    @property
    def motors(self) -> tuple[str, ...]:
        """Translate [m/s], steer [rad/s], turret [rad/s]."""
        return ("translate", "steer", "turret") if self.turret else ("translate", "steer")

    @property
    def encoders(self) -> tuple[str, ...]:
        """Way [m]; angles of the wheels and of the turret [rad]."""
        return self.motors

    def travel(self, encoders: Sequence[float], heading: float) -> Travel:
        """Return what the encoders say: steer and turret tell directions in the world."""
        forward, steer, *turret = encoders
        return Travel(forward, 0.0, steer, turret[0] if turret else 0.0)

    def move(
        self, heading: float, length: float, travel: Travel, config: MotionConfig, timestep: float
    ) -> Move:
        """Return a move: steer, then translate, forward or backward."""
        return _SynchroMove(
            self, StraightMove(heading, length, travel.heading, self.limits, config, timestep)
        )

    def twist(
        self, forward: float, sideways: float, turn: float, travel: Travel
    ) -> tuple[float, ...]:
        """Return the motors' speeds; the turret goes back to looking along +x."""
        turret = (-_TURRET_GAIN * travel.sensors,) if self.turret else ()
        return forward, turn, *turret


class _SynchroMove(Move):
    def __init__(self, drive: SynchroDrive, straight: StraightMove) -> None:
        self.straight = straight
        self._drive = drive

    def command(self, travel: Travel, free: float, bumped: bool) -> tuple[float, ...]:
        speed, turn = self.straight.command(travel.forward, travel.heading, free, bumped)
        return self._drive.twist(speed, 0.0, turn, travel)
