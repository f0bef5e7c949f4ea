"""Options of the motor task."""

from dataclasses import dataclass, field

from nomad_mj.errors import ConfigError
from nomad_mj.option_types import check_fields
from nomad_mj.tasks.bumpers import BumperNoise
from nomad_mj.tasks.gyroscope import Gyroscope
from nomad_mj.tasks.infrared import InfraredEffects
from nomad_mj.tasks.noise import OdometryNoise, RangeNoise
from nomad_mj.tasks.sonar import SonarEffects


@dataclass(frozen=True)
class MotorConfig:
    """Options of the motor task.

    Attributes
    ----------
    range_noise, odometry_noise, sonar, bumper_noise
        How the sensors err.
    infrared : InfraredEffects, optional
        Infrared sensors judge distance by the light that comes back; None: they measure it.
    gyroscope : Gyroscope, optional
        What corrects the heading by odometry.
    goal_radius : float
        The goal is reached when the robot's centre is this near [m].
    ends_at_goal : bool
        Whether reaching the goal ends the episode.
    """

    range_noise: RangeNoise = field(default_factory=RangeNoise)
    odometry_noise: OdometryNoise = field(default_factory=OdometryNoise)
    sonar: SonarEffects = field(default_factory=SonarEffects)
    infrared: InfraredEffects | None = None
    bumper_noise: BumperNoise = field(default_factory=BumperNoise)
    gyroscope: Gyroscope | None = None
    goal_radius: float = 0.2
    ends_at_goal: bool = True

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.goal_radius > 0:
            raise ConfigError(f"goal radius {self.goal_radius}: must be above 0 m")
