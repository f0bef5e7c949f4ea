"""Look a robot's or a room's file over before anything is learnt with it."""

from nomad_agents.checks.calibration import calibrate, find_drift_faults
from nomad_agents.checks.faults import find_faults
from nomad_agents.checks.patterns import Drift, drive_patterns
from nomad_agents.checks.picture import draw_robot_card
from nomad_agents.checks.room_faults import find_room_faults
from nomad_agents.checks.tables import (
    drift_table,
    robot_table,
    robot_values,
    room_values,
    sensor_table,
)

__all__ = [
    "Drift",
    "calibrate",
    "draw_robot_card",
    "drift_table",
    "drive_patterns",
    "find_drift_faults",
    "find_faults",
    "find_room_faults",
    "robot_table",
    "robot_values",
    "room_values",
    "sensor_table",
]
