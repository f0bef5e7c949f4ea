"""What figures are drawn from, as data that JSON can hold: ways, actions, categories, films.

All lengths in metres, all angles in radians, in the world frame.
"""

from collections.abc import Sequence
from typing import TypedDict

import numpy as np

from nomad_agents.agent import Agent
from nomad_agents.evaluation import Trial
from nomad_agents.training import stream
from nomad_mj.envs import PathFinding, percept_of
from nomad_mj.motion import displacement
from nomad_mj.types import FloatArray

_ACTIONS = 21  # a stream of random numbers
_DIGITS = 4  # a tenth of a millimetre
LATTICE = 0.5  # [m] between the places of Fig 7


class Way(TypedDict):
    """Where the robot went: `track` (n, 2), first the start."""

    track: list[list[float]]
    reached: bool


class Action(TypedDict):
    """What an agent does at a place: kind of `Decision`, its category, -1 for none."""

    place: list[float]
    move: list[float]
    kind: str
    unmatched: bool
    category: int


def rounded(values: FloatArray) -> list[list[float]]:
    """Return an array (n, k) as lists, to a tenth of a millimetre."""
    return np.round(values, _DIGITS).tolist()


def way(trial: Trial) -> Way:
    """Return where the robot went, a point every 0.2 s or so."""
    track = trial.track
    kept = np.unique(np.append(np.arange(0, len(track), 4), len(track) - 1))
    return {"track": rounded(track[kept]), "reached": trial.episode.reached}


def action_map(env: PathFinding, agent: Agent, places: FloatArray, seed: int) -> list[Action]:
    """Return what a greedy agent does at each of the places (n, 2), with real readings there."""
    actions: list[Action] = []
    for number, place in enumerate(places):
        step = env.reset(stream(seed, _ACTIONS, number), tuple(place.tolist()))
        percept = percept_of(step.observation, agent.layout, agent.situation)
        agent.start_episode(env.motor.task.random)
        decision = agent.act(percept, None)
        move = displacement(decision.action, percept.goal, env.config.action)
        actions.append(
            {
                "place": np.round(place, _DIGITS).tolist(),
                "move": np.round(move, _DIGITS).tolist(),
                "kind": decision.kind,
                "unmatched": decision.unmatched,
                "category": decision.category,
            }
        )
    return actions


def spread_starts(env: PathFinding, count: int) -> list[int]:
    """Return the numbers of `count` of a room's starts, of all if it has fewer, far apart."""
    places, chosen = env.scene.arena.starts[:, :2], [0]
    while len(chosen) < min(count, len(places)):
        off = np.hypot(*(places[:, None] - places[chosen]).transpose(2, 0, 1)).min(axis=1)
        chosen.append(int(np.argmax(off)))
    return chosen


def share_alike(actions: Sequence[Action], others: Sequence[Action], angle: float) -> float:
    """Return the share of places where two maps of actions point within `angle` of each other."""
    a, b = (np.array([each["move"] for each in some]) for some in (actions, others))
    cross, dot = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0], (a * b).sum(axis=1)
    return float((np.abs(np.arctan2(cross, dot)) <= angle).mean())


class Film(TypedDict):
    """Everything that moves in an episode, at `times` (t,) [s] since its start.

    `robot` (t, 3): x, y, heading of the wheels; `goal` (t, 2); `obstacles` (t, k, 2), discs of
    `radius`.
    """

    times: list[float]
    robot: list[list[float]]
    goal: list[list[float]]
    obstacles: list[list[list[float]]]
    radius: float
    reached: bool
