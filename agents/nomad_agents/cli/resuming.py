"""Whether a training can go on from a checkpoint to the same bits, and from where."""

from pathlib import Path

from nomad_agents.checkpoint import Checkpoint, structure
from nomad_agents.reactive_planner import ReactivePlannerConfig
from nomad_agents.training import Training
from nomad_mj.errors import CheckpointError
from nomad_mj.scene import Scene


def require_same_training(
    checkpoint: Checkpoint, path: Path, scene: Scene, seed: int, config: ReactivePlannerConfig
) -> None:
    """Raise CheckpointError unless the checkpoint at `path` is of this training."""
    robot, layout = scene.robot, checkpoint.layout
    wanted = (scene.arena.name, robot.name, robot.layout, seed, config)
    found = (
        checkpoint.room,
        checkpoint.robot,
        robot.layout if layout.matches(robot.layout) else layout,
        checkpoint.training.get("seed"),
        checkpoint.agent.config,
    )
    for what, mine, theirs in zip(
        ("room", "robot", "set of sensors", "seed", "config"), wanted, found, strict=True
    ):
        if mine != theirs:
            told = f": {theirs}, not {mine}" if isinstance(mine, str | int) else ""
            raise CheckpointError(f"cannot resume {str(path)!r}: it is of another {what}{told}")


def require_same_files(checkpoint: Checkpoint, path: Path, digests: list[str]) -> None:
    """Raise CheckpointError if the files of room and robot have changed since.

    `digests` are theirs now; a checkpoint of before these were kept tells of none.
    """
    before = checkpoint.conditions.get("files", digests)
    for place, what in enumerate(("room", "robot")):
        if not isinstance(before, list) or before[place : place + 1] != [digests[place]]:
            raise CheckpointError(
                f"cannot resume {str(path)!r}: the file of its {what} has changed since; train "
                "anew, or go on in the new one with --agent and another --out"
            )


def training_of(checkpoint: Checkpoint, path: Path, starts: int) -> Training:
    """Return how far the training is, in a room with so many starts.

    Raises
    ------
    CheckpointError
        The checkpoint holds no such state.
    """
    state = {name: value for name, value in checkpoint.training.items() if name != "seed"}
    try:
        training = structure(state, Training)
    except Exception:
        raise CheckpointError(f"checkpoint {str(path)!r} holds no state of training") from None
    counts = [value for name, value in state.items() if name not in ("testing", "done")]
    if min(counts) < 0 or training.passes < 1 or training.solved > training.tested:
        raise CheckpointError(f"checkpoint {str(path)!r} holds no state of training")
    if max(training.next_start, training.tested - 1) >= starts:
        raise CheckpointError(
            f"cannot resume {str(path)!r}: it is of a room with more starts than {starts}"
        )
    return training
