"""What the rest of the package knows of a way to drive: a move in, motor commands out.

A new kind of drive is a class with the members of `Drive`; `robots.drives` makes one from a file.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Protocol

from nomad_mj.motion.config import MotionConfig, Outcome
from nomad_mj.motion.straight import StraightMove
from nomad_mj.types import MotionLimits, Travel


class Move(ABC):
    """A move under way: an endless source of motor commands until it is done."""

    straight: StraightMove

    @property
    def motion_heading(self) -> float:
        """Where the robot drives next or drives now [rad]: what is ahead lies there."""
        return self.straight.motion_heading

    @property
    def outcome(self) -> Outcome:
        """NONE until the move's fate is known."""
        return self.straight.outcome

    @property
    def done(self) -> bool:
        """The robot stands still, the move is over."""
        return self.straight.done

    @abstractmethod
    def command(self, travel: Travel, free: float, bumped: bool) -> tuple[float, ...]:
        """Return the motors' commands for the next control step.

        Parameters
        ----------
        travel : Travel
            Way since the last call, and directions by odometry.
        free : float
            Shortest reading ahead, that is about `motion_heading` [m].
        bumped : bool
            Whether a bumper has been touched since the last call that was not before: what is
            touched already may be what the move leads away from.
        """


class Drive(Protocol):
    """How a robot drives: pure, without physics."""

    @property
    def kind(self) -> str:
        """Name of the kind of drive."""
        ...

    @property
    def motors(self) -> tuple[str, ...]:
        """Names of the actuators, in the order of commands."""
        ...

    @property
    def encoders(self) -> tuple[str, ...]:
        """What the encoders count, by the names of the motors: ways [m], then angles [rad]."""
        ...

    @property
    def limits(self) -> MotionLimits:
        """Largest speeds and accelerations of the robot as a whole."""
        ...

    def travel(self, encoders: Sequence[float], heading: float) -> Travel:
        """Return what readings of the encoders say of a control step.

        Parameters
        ----------
        encoders : sequence of float, as many as `encoders`
            Ways since the last control step [m], angles now [rad].
        heading : float
            Of the robot at the last control step [rad].
        """
        ...

    def move(
        self, heading: float, length: float, travel: Travel, config: MotionConfig, timestep: float
    ) -> Move:
        """Return a straight move, in the frame of odometry.

        Parameters
        ----------
        heading, length : float
            Where to [rad] and how far [m].
        travel : Travel
            Present directions.
        config, timestep
            How carefully; of control [s].
        """
        ...

    def twist(
        self, forward: float, sideways: float, turn: float, travel: Travel
    ) -> tuple[float, ...]:
        """Return the motors' commands for speeds [m/s], [m/s], [rad/s], as near as can be.

        For driving by hand. What the drive cannot do, such as going sideways, is left out.
        """
        ...
