"""Fig 6 over many seeds: learn a room, then find the goal from starts never seen."""

from collections.abc import Sequence

import numpy as np

import nomad_mj
from nomad_agents.agent import Agent
from nomad_agents.evaluation import draw_starts, evaluate, summarise
from nomad_agents.experiments.runs import Row, Run
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.registry import find_config, make_agent
from nomad_agents.training import Training, TrainingConfig, train, training_report

UNSEEN_STARTS = 200
UNSEEN_SEED = 1_000_000  # far from the seeds that train
BASELINES = ("straight", "planner")
BASELINE_SEEDS = 5  # they learn nothing: only the noise of their sensors differs between runs
_DECISIONS = 50  # after which an evaluated episode is given up


def learn_and_evaluate(run: Run) -> Row:
    """Train an agent that learns, then evaluate it, or a baseline, on the unseen starts."""
    with nomad_mj.load("path_finding", room=run.room, robot=run.robot) as env:
        config = find_config(run.config)
        row: Row = {}
        agent: Agent = make_agent(run.agent, env.scene.robot.layout, config)
        if isinstance(agent, ReactivePlanner):
            training = train(env, agent, TrainingConfig(run.seed), Training())
            row |= {f"learn_{k}": v for k, v in training_report(env, agent, training).items()}
        starts = draw_starts(env, UNSEEN_STARTS, UNSEEN_SEED)
        trials = evaluate(env, agent, starts, UNSEEN_SEED + run.seed, _DECISIONS)
        return row | summarise(env, trials)


def quartiles(rows: Sequence[Row], key: str) -> tuple[float, float, float]:
    """Return the first quartile, the median and the third quartile of a column."""
    values = [float(row[key]) for row in rows]
    first, middle, third = np.percentile(values, [25, 50, 75]).tolist()
    return first, middle, third
