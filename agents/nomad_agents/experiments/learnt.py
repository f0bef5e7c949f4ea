"""Agents that have learnt, with the curve of their learning, kept for the experiments after it."""

from dataclasses import asdict
from pathlib import Path

import nomad_mj
from nomad_agents.agent import Agent
from nomad_agents.checkpoint import load_checkpoint, save_checkpoint
from nomad_agents.experiments.experiment import LEARNER
from nomad_agents.reactive_planner import ReactivePlanner, ReactivePlannerConfig
from nomad_agents.registry import find_config, make_agent
from nomad_agents.studies.learning import learn
from nomad_agents.studies.runs import Result, Run, stored_result
from nomad_agents.training import Training, TrainingConfig
from nomad_mj.envs import PathFinding
from nomad_mj.errors import OutputError

TRAINING = "training"
_MOST_PASSES = 40


def training_run(run: Run) -> Run:
    """Return the run in which the agent of another run has learnt its room."""
    return Run(TRAINING, "", LEARNER, run.config, run.room, run.robot, run.seed)


def _checkpoint(run: Run, folder: Path) -> Path:
    return (folder / "agents" / run.file_name).with_suffix(".npz")


def keep_agent(run: Run, folder: Path, env: PathFinding, agent: ReactivePlanner) -> None:
    """Save the agent as a run has left it."""
    state = asdict(Training(plannings=agent.plannings)) | {"seed": run.seed}
    room, robot = env.scene.arena.name, env.scene.robot.name
    save_checkpoint(_checkpoint(run, folder), agent, room, robot, state)


def kept_agent(run: Run, folder: Path) -> ReactivePlanner:
    """Return the agent as a run has left it; raises CheckpointError if there is none."""
    return load_checkpoint(_checkpoint(run, folder)).agent


def new_learner(
    result: Result,
    folder: Path,
    env: PathFinding,
    config: ReactivePlannerConfig,
    settings: TrainingConfig,
) -> ReactivePlanner:
    """Return an agent that has learnt anew, kept for seed 0; `result` takes in how it learnt."""
    agent = ReactivePlanner(env.scene.robot.layout, config)
    row, result.curve = learn(env, agent, settings)
    result.row |= row
    if result.run.seed == 0:
        keep_agent(result.run, folder, env, agent)
    return agent


def forget_lost(run: Run, folder: Path) -> None:
    """Remove the result of a training whose agent is not on file: it has to learn again."""
    if not _checkpoint(run, folder).is_file():
        (folder / run.file_name).unlink(missing_ok=True)


def train_room(run: Run, folder: Path) -> Result:
    """Let an agent learn its room and keep it."""
    with nomad_mj.load("path_finding", room=run.room, robot=run.robot) as env:
        agent = ReactivePlanner(env.scene.robot.layout, find_config(run.config))
        row, curve = learn(env, agent, TrainingConfig(run.seed, max_passes=_MOST_PASSES))
        keep_agent(run, folder, env, agent)
    return Result(run, row, curve=curve)


def trained_agent(run: Run, folder: Path) -> tuple[ReactivePlanner, Result]:
    """Return a fresh copy of the agent that learnt the room of `run`, and how it learnt.

    Raises
    ------
    OutputError, CheckpointError
        It is not on file: its training comes first, see `training_run`.
    """
    own = training_run(run)
    result = stored_result(own, folder)
    if result is None:
        raise OutputError(f"{str(folder / own.file_name)!r} is missing: run the experiment again")
    return kept_agent(own, folder), result


def acting_agent(run: Run, folder: Path, env: PathFinding) -> Agent:
    """Return the agent of a run: the trained one, or a baseline."""
    if run.agent == LEARNER:
        return trained_agent(run, folder)[0]
    return make_agent(run.agent, env.scene.robot.layout, find_config(run.config))
