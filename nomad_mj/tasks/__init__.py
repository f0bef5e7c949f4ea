"""The motor task: the robot's sensors and motors as a dm_control environment."""

from nomad_mj.tasks.bumpers import BumperNoise
from nomad_mj.tasks.config import MotorConfig
from nomad_mj.tasks.crosstalk import Crosstalk
from nomad_mj.tasks.environment import MotorEnvironment
from nomad_mj.tasks.firing import FiringOrder
from nomad_mj.tasks.gyroscope import Gyroscope
from nomad_mj.tasks.infrared import InfraredEffects
from nomad_mj.tasks.motor import MotorTask
from nomad_mj.tasks.noise import OdometryNoise, RangeNoise
from nomad_mj.tasks.physics import NavigationPhysics
from nomad_mj.tasks.sonar import SonarEffects
from nomad_mj.tasks.starts import Start, resolve_start

__all__ = [
    "BumperNoise",
    "Crosstalk",
    "FiringOrder",
    "Gyroscope",
    "InfraredEffects",
    "MotorConfig",
    "MotorEnvironment",
    "MotorTask",
    "NavigationPhysics",
    "OdometryNoise",
    "RangeNoise",
    "SonarEffects",
    "Start",
    "resolve_start",
]
