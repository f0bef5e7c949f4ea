"""Many robots in one process: the motor task and path finding on the engine's batch."""

from nomad_mj.batch.environment import BatchEnvironment
from nomad_mj.batch.load import load_batch
from nomad_mj.batch.motor import BatchMotor
from nomad_mj.batch.path_finding import BatchPathFinding
from nomad_mj.batch.timestep import BatchTimeStep
from nomad_mj.batch.worlds import Worlds, world_seed

__all__ = [
    "BatchEnvironment",
    "BatchMotor",
    "BatchPathFinding",
    "BatchTimeStep",
    "Worlds",
    "load_batch",
    "world_seed",
]
