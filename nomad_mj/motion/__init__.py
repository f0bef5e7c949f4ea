"""From an action to motor commands: pure, without physics."""

from nomad_mj.motion.action import ActionSpec, displacement
from nomad_mj.motion.car import CarDrive
from nomad_mj.motion.config import MotionConfig, Outcome
from nomad_mj.motion.drive import Drive, Move
from nomad_mj.motion.reinforcement import SAFE_CLEARANCE, reinforcement
from nomad_mj.motion.straight import StraightMove, ramp_speed
from nomad_mj.motion.synchro import SynchroDrive
from nomad_mj.motion.wheeled import WheeledDrive

__all__ = [
    "SAFE_CLEARANCE",
    "ActionSpec",
    "CarDrive",
    "Drive",
    "MotionConfig",
    "Move",
    "Outcome",
    "StraightMove",
    "SynchroDrive",
    "WheeledDrive",
    "displacement",
    "ramp_speed",
    "reinforcement",
]
