"""What is measured of an agent: episodes from starts never seen, and its map of actions."""

from collections.abc import Sequence

import numpy as np

from nomad_agents.agent import Agent
from nomad_agents.evaluation import Trial, draw_starts, evaluate, summarise
from nomad_agents.experiments.pictures import Action
from nomad_agents.experiments.runs import Row
from nomad_mj.arenas import Geodesic
from nomad_mj.envs import PathFinding
from nomad_mj.types import FloatArray

UNSEEN_SEED = 1_000_000  # far from the seeds that train
UNSEEN_STARTS = 25  # where nothing else is said: many cases share the time
DECISIONS = 50  # after which an evaluated episode is given up
_PROGRESS = 0.5  # of a move's length


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


def judge_actions(env: PathFinding, actions: Sequence[Action]) -> Row:
    """Return the shares of places where an agent knows what to do, and where that is suitable.

    A move is suitable if it goes clear of everything and comes nearer to the goal, along the
    shortest path, by half its length at least.

    Returns
    -------
    dict
        ``known``: a category acts that matches the situation; ``suitable`` among all places;
        ``known_suitable`` among those where it is known, NaN where there are none.
    """
    scene = env.scene
    radius = scene.robot.layout.radius
    places = np.array([action["place"] for action in actions])
    moves = np.array([action["move"] for action in actions])
    known = np.array([a["kind"] == "reacted" and not a["unmatched"] for a in actions])
    geodesic = Geodesic(scene.plan, scene.arena.goal, radius)
    gained = geodesic.length(places) - geodesic.length(places + moves)
    shares = np.linspace(0.0, 1.0, 11)[:, None, None]
    clear = (scene.plan.clearance(places + shares * moves, radius) > 0).all(axis=0)
    length = np.hypot(moves[:, 0], moves[:, 1])
    suitable = clear & (length > 0) & (gained >= _PROGRESS * length)
    return {
        "known": float(known.mean()),
        "suitable": float(suitable.mean()),
        "known_suitable": float(suitable[known].mean()) if known.any() else float("nan"),
    }
