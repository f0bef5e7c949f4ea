"""Wheels that are not steered: two make a differential drive, three omni wheels go anywhere.

A wheel i at p_i that rolls along d_i turns as fast as its place moves along d_i: its speed is
d_i . (v + w x p_i). These rows make one matrix for every arrangement; where its rank is 3 the robot
can go sideways (K. M. Lynch and F. C. Park, "Modern Robotics", 2017, section 13.2).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nomad_mj.motion.config import MotionConfig
from nomad_mj.motion.drive import Move
from nomad_mj.motion.straight import StraightMove
from nomad_mj.types import MotionLimits, Travel

_HOLD_GAIN = 4.0  # [1/s] with which an omnidirectional robot holds its heading


@dataclass(frozen=True)
class WheeledDrive:
    """Wheels with fixed axles: see `Drive`.

    Attributes
    ----------
    limits : MotionLimits
        Of the robot as a whole.
    motors : tuple of str
        The wheels' actuators.
    rows : tuple of (float, float, float)
        Of each wheel: its speed on the floor [m/s] per speed of the robot forward [m/s], to the
        left [m/s] and turning left [rad/s].
    gains : tuple of float
        Command of each motor per speed of its wheel on the floor [1/(m/s)].
    fastest : tuple of float
        Largest speed of each wheel on the floor [m/s].
    axle : float
        How far behind the robot's origin the axle of a differential drive is [m].
    sees_behind : bool
        Whether range sensors look back: only then does it drive backwards into the unknown.
    """

    limits: MotionLimits
    motors: tuple[str, ...]
    rows: tuple[tuple[float, float, float], ...]
    gains: tuple[float, ...]
    fastest: tuple[float, ...]
    axle: float = 0.0
    sees_behind: bool = False

    @property
    def kind(self) -> str:
        """``"omni"`` if the robot can go sideways, else ``"differential"``."""
        return "omni" if self._rank == 3 else "differential"

    @cached_property
    def _rank(self) -> int:
        return int(np.linalg.matrix_rank(np.array(self.rows), tol=1e-3))

    @property
    def encoders(self) -> tuple[str, ...]:
        """Way of each wheel on the floor [m]."""
        return self.motors

    @cached_property
    def _inverse(self) -> list[list[float]]:
        """Ways of the robot per way of each wheel, (3, wheels)."""
        return np.linalg.pinv(np.array(self.rows)).tolist()

    def travel(self, encoders: Sequence[float], heading: float) -> Travel:
        """Return what the wheels' ways say; the sensors turn with the robot."""
        forward, sideways, turned = (
            sum(share * way for share, way in zip(row, encoders, strict=True))
            for row in self._inverse
        )
        if self.axle:  # which goes straight ahead, so the origin swings about it
            sideways += self.axle * turned
        return Travel(forward, sideways, heading + turned, heading + turned)

    def move(
        self, heading: float, length: float, travel: Travel, config: MotionConfig, timestep: float
    ) -> Move:
        """Return a move: a differential drive turns first, an omnidirectional one drives off."""
        kind = _OmniMove if self.kind == "omni" else _DifferentialMove
        return kind(self, heading, length, travel, config, timestep)

    def twist(
        self, forward: float, sideways: float, turn: float, travel: Travel
    ) -> tuple[float, ...]:
        """Return the motors' commands; all slower alike where one wheel cannot go as fast."""
        speeds = [row[0] * forward + row[1] * sideways + row[2] * turn for row in self.rows]
        most = max(abs(s) / top for s, top in zip(speeds, self.fastest, strict=True))
        share = 1.0 / max(most, 1.0)
        return tuple(share * s * gain for s, gain in zip(speeds, self.gains, strict=True))


class _DifferentialMove(Move):
    def __init__(
        self,
        drive: WheeledDrive,
        heading: float,
        length: float,
        travel: Travel,
        config: MotionConfig,
        timestep: float,
    ) -> None:
        if drive.axle:
            heading, length = _from_axle(drive, heading, length, travel.heading)
        self.straight = StraightMove(
            heading,
            length,
            travel.heading,
            drive.limits,
            config,
            timestep,
            reverses=drive.sees_behind,
        )
        self._drive = drive

    def command(self, travel: Travel, free: float, bumped: bool) -> tuple[float, ...]:
        speed, turn = self.straight.command(travel.forward, travel.heading, free, bumped)
        return self._drive.twist(speed, 0.0, turn, travel)


def _from_axle(
    drive: WheeledDrive, heading: float, length: float, facing: float
) -> tuple[float, float]:
    """Return direction and length of the move that takes the robot's origin where it should be.

    It turns about the middle of its axle, so that its origin swings round first.
    """
    along = length * math.cos(heading) + drive.axle * math.cos(facing)
    across = length * math.sin(heading) + drive.axle * math.sin(facing)
    heading = math.atan2(across, along)
    ahead = abs(math.remainder(heading - facing, 2 * math.pi)) <= math.pi / 2
    swing = drive.axle if ahead or not drive.sees_behind else -drive.axle
    return heading, max(math.hypot(along, across) - swing, 0.0)


class _OmniMove(Move):
    """Goes in any direction and keeps its heading on the way."""

    def __init__(
        self,
        drive: WheeledDrive,
        heading: float,
        length: float,
        travel: Travel,
        config: MotionConfig,
        timestep: float,
    ) -> None:
        self.straight = StraightMove(
            heading, length, heading, drive.limits, config, timestep, turns_first=False
        )
        self._drive, self._direction, self._heading = drive, heading, travel.heading

    def command(self, travel: Travel, free: float, bumped: bool) -> tuple[float, ...]:
        angle = self._direction - travel.heading
        cos, sin = math.cos(angle), math.sin(angle)
        way = travel.forward * cos + travel.sideways * sin
        speed, _ = self.straight.command(way, self._direction, free, bumped)
        turn = _HOLD_GAIN * math.remainder(self._heading - travel.heading, 2 * math.pi)
        return self._drive.twist(speed * cos, speed * sin, turn, travel)
