"""From an action to motor commands: pure, without physics."""

from nomad_mj.motion.action import ActionSpec, displacement
from nomad_mj.motion.reinforcement import SAFE_CLEARANCE, reinforcement
from nomad_mj.motion.synchro import MotionConfig, Outcome, SynchroMove, ramp_speed

__all__ = [
    "SAFE_CLEARANCE",
    "ActionSpec",
    "MotionConfig",
    "Outcome",
    "SynchroMove",
    "displacement",
    "ramp_speed",
    "reinforcement",
]
