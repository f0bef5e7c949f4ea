"""The motor task: the robot's sensors and motors as a dm_control environment."""

from nomad_mj.tasks.environment import MotorEnvironment
from nomad_mj.tasks.motor import MotorConfig, MotorTask
from nomad_mj.tasks.noise import OdometryNoise, RangeNoise
from nomad_mj.tasks.physics import NavigationPhysics
from nomad_mj.tasks.starts import Start, resolve_start

__all__ = [
    "MotorConfig",
    "MotorEnvironment",
    "MotorTask",
    "NavigationPhysics",
    "OdometryNoise",
    "RangeNoise",
    "Start",
    "resolve_start",
]
