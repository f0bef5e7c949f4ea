"""nomad_mj: a simulated Nomad 200 that learns to find its goal, on MuJoCo and dm_control."""

from nomad_mj._gl import choose_backend

choose_backend()  # before anything imports mujoco or dm_control, which read MUJOCO_GL only once

from nomad_mj.assets import list_robots, list_rooms  # noqa: E402
from nomad_mj.batch import BatchMotor, BatchPathFinding, BatchTimeStep, load_batch  # noqa: E402
from nomad_mj.envs import PathFinding, PathFindingConfig, load  # noqa: E402
from nomad_mj.errors import NomadError  # noqa: E402
from nomad_mj.motion import Outcome  # noqa: E402
from nomad_mj.movers import MovingGoal, MovingObstacles, Walkers  # noqa: E402
from nomad_mj.tasks import (  # noqa: E402
    BumperNoise,
    Crosstalk,
    FiringOrder,
    Gyroscope,
    InfraredEffects,
    MotorConfig,
    MotorEnvironment,
    OdometryNoise,
    RangeNoise,
    SonarEffects,
)

__version__ = "0.1.0"

__all__ = [
    "BatchMotor",
    "BatchPathFinding",
    "BatchTimeStep",
    "BumperNoise",
    "Crosstalk",
    "FiringOrder",
    "Gyroscope",
    "InfraredEffects",
    "MotorConfig",
    "MotorEnvironment",
    "MovingGoal",
    "MovingObstacles",
    "NomadError",
    "OdometryNoise",
    "Outcome",
    "PathFinding",
    "PathFindingConfig",
    "RangeNoise",
    "SonarEffects",
    "Walkers",
    "list_robots",
    "list_rooms",
    "load",
    "load_batch",
]
