"""Gymnasium's environments; importing this registers them, see `registration`."""

from nomad_mj.gym.base import NavigationEnv
from nomad_mj.gym.motor import MotorEnv
from nomad_mj.gym.path_finding import PathFindingEnv
from nomad_mj.gym.registration import register
from nomad_mj.gym.vector import NavigationVectorEnv

register()

__all__ = ["MotorEnv", "NavigationEnv", "NavigationVectorEnv", "PathFindingEnv", "register"]
