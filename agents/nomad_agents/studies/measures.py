"""What is measured of an agent: episodes from starts never seen."""

from collections.abc import Sequence

from nomad_agents.agent import Agent
from nomad_agents.evaluation import Trial, draw_starts, evaluate, summarise
from nomad_agents.studies.runs import Row
from nomad_mj.envs import PathFinding
from nomad_mj.types import FloatArray

UNSEEN_SEED = 1_000_000  # far from the seeds that train
UNSEEN_STARTS = 25  # where nothing else is said: many cases share the time
DECISIONS = 50  # after which an evaluated episode is given up


def unseen_starts(env: PathFinding, count: int = UNSEEN_STARTS) -> FloatArray:
    """Return the starts (count, 3) of every evaluation: the same for all seeds."""
    return draw_starts(env, count, UNSEEN_SEED)


def assess(
    env: PathFinding,
    agent: Agent,
    seed: int,
    count: int = UNSEEN_STARTS,
    decisions: int = DECISIONS,
) -> tuple[Row, list[Trial]]:
    """Run a greedy agent from unseen starts; return its metrics (see `summarise`) and episodes."""
    starts = unseen_starts(env, count)
    trials = evaluate(env, agent, starts, UNSEEN_SEED + seed, decisions)
    return dict(summarise(env, trials)), trials


def episode_rows(trials: Sequence[Trial], **columns: str | int) -> list[Row]:
    """Return one row an episode, with some columns of the same value in each."""
    return [
        {
            **columns,
            "x": float(trial.start[0]),
            "y": float(trial.start[1]),
            "heading": float(trial.start[2]),
            **trial.episode._asdict(),
            "length": trial.length,
            "shortest": trial.shortest,
        }
        for trial in trials
    ]
