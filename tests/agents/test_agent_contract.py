"""What every registered agent promises, on real percepts."""

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from conftest import See
from nomad_agents.agent import Agent
from nomad_agents.episode import Turn, run_episode
from nomad_agents.reactive_planner import CONFIGS, ReactivePlanner
from nomad_agents.registry import AGENTS, find_config, make_agent

from nomad_mj.envs import PathFinding
from nomad_mj.errors import UnknownNameError
from nomad_mj.perception import Percept
from nomad_mj.types import FloatArray, SensorLayout

# Agents that remember, within an episode, what they did or saw there.
REMEMBERS = ("random", "vfh", "potential", "dwa")
CASES = [(name, config) for name in AGENTS for config in CONFIGS]


def percepts(see: See, agent: Agent, count: int = 40) -> list[Percept]:
    rng = np.random.default_rng(0)
    goals = [*rng.uniform(-6, 6, (count, 2)), np.zeros(2), np.array([1e-9, 0.0])]
    return [see(goal, rng.uniform(0.15, 4.0, 16), spec=agent.situation) for goal in goals]


def memory(agent: Agent) -> dict[str, Any]:
    """Return all that an agent holds, down to the bits."""
    state = {k: v for k, v in vars(agent).items() if k != "network"}
    for key, value in state.items():
        if isinstance(value, np.random.Generator):
            state[key] = value.bit_generator.state
        elif isinstance(value, np.ndarray):
            state[key] = value.tobytes()
    if isinstance(agent, ReactivePlanner):
        state |= {k: v.tobytes() for k, v in agent.network.arrays().items()}
    return {key: repr(value) for key, value in state.items()}


def experienced(see: See, layout: SensorLayout, name: str, config: str) -> Agent:
    """Return an agent that has learnt a little if it learns."""
    agent = make_agent(name, layout, find_config(config))
    rng = np.random.default_rng(1)
    seen = percepts(see, agent, 12)
    for now, after in pairwise(seen):
        agent.learn(now, agent.act(now, rng), -rng.random(), bool(rng.random() < 0.2), after)
    agent.reach_goal(seen[-1], agent.act(seen[-1], rng), -0.1)
    return agent


@pytest.mark.parametrize(("name", "config"), CASES)
def test_actions_are_two_finite_numbers_in_range(
    see: See, layout: SensorLayout, name: str, config: str
) -> None:
    for agent in (make_agent(name, layout, find_config(config)),) * 2 + (
        experienced(see, layout, name, config),
    ):
        for percept in percepts(see, agent):
            for explore in (None, np.random.default_rng(0)):
                decision = agent.act(percept, explore)
                assert decision.action.shape == (2,) and decision.action.dtype == np.float64
                assert np.isfinite(decision.action).all() and np.abs(decision.action).max() <= 1
                assert decision.kind in ("reacted", "planned", "none")


@pytest.mark.parametrize(("name", "config"), CASES)
def test_a_greedy_agent_repeats_an_episode_and_keeps_nothing_of_it(
    see: See, layout: SensorLayout, name: str, config: str
) -> None:
    agent = experienced(see, layout, name, config)
    agent.start_episode(np.random.default_rng(5))
    before, seen = memory(agent), percepts(see, agent)
    first = [agent.act(percept, None).action.tobytes() for percept in seen]
    agent.start_episode(np.random.default_rng(5))
    assert memory(agent) == before
    assert [agent.act(percept, None).action.tobytes() for percept in seen] == first


@pytest.mark.parametrize(("name", "config"), [c for c in CASES if c[0] not in REMEMBERS])
def test_a_greedy_agent_without_a_memory_of_the_episode_is_unchanged_by_it(
    see: See, layout: SensorLayout, name: str, config: str
) -> None:
    agent = experienced(see, layout, name, config)
    agent.start_episode()
    before, seen = memory(agent), percepts(see, agent)
    first = [agent.act(percept, None).action.tobytes() for percept in seen]
    assert memory(agent) == before
    assert [agent.act(percept, None).action.tobytes() for percept in reversed(seen)] == first[::-1]


@pytest.mark.parametrize("name", REMEMBERS)
def test_an_agent_that_remembers_does_change_within_an_episode(
    see: See, layout: SensorLayout, name: str
) -> None:
    agent = make_agent(name, layout, find_config("faithful"))
    agent.start_episode(np.random.default_rng(5))
    before = memory(agent)
    agent.act(see(), None)
    assert memory(agent) != before


@pytest.mark.parametrize(("name", "config"), CASES)
def test_the_same_stream_gives_the_same_experience(
    see: See, layout: SensorLayout, name: str, config: str
) -> None:
    one, other = (experienced(see, layout, name, config) for _ in range(2))
    assert memory(one) == memory(other)


@pytest.mark.parametrize("name", AGENTS)
def test_who_changes_a_decision_does_not_change_the_agent(
    see: See, layout: SensorLayout, name: str
) -> None:
    agent = experienced(see, layout, name, "faithful")
    percept = see()
    agent.start_episode(np.random.default_rng(5))
    first = agent.act(percept, None)
    kept = first.action.copy()
    if first.action.flags.writeable:
        first.action[:] = 0.123
    agent.start_episode(np.random.default_rng(5))
    assert np.array_equal(agent.act(percept, None).action, kept)


def test_unknown_names_list_what_there_is(layout: SensorLayout) -> None:
    names = "dwa, planner, potential, random, reactive_planner, straight, vfh"
    with pytest.raises(UnknownNameError, match=rf"there are: {names}$"):
        make_agent("nobody", layout, find_config("faithful"))
    with pytest.raises(UnknownNameError, match=r"there are: faithful, tuned$"):
        find_config("best")


@pytest.mark.parametrize("name", AGENTS)
def test_an_episode_counts_what_happened(env: PathFinding, name: str) -> None:
    agent = make_agent(name, env.scene.robot.layout, find_config("faithful"))
    turns: list[Turn] = []
    episode = run_episode(env, agent, seed=2, start=0, max_decisions=6, watch=turns.append)
    done = [turn.after for turn in turns if turn.after is not None]
    assert episode.decisions == len(done) == len(turns) / 2 <= 6
    seen: list[dict[str, FloatArray]] = [step.observation for step in done]
    assert episode.duration == pytest.approx(sum(o["duration"] for o in seen))
    assert episode.driven == pytest.approx(sum(o["driven"] for o in seen))
    assert episode.virtual_collisions == sum(o["outcome"] == 2 for o in seen)
    assert episode.clearance <= min(o["clearance"] for o in seen)
    assert episode.reactions == sum(t.decision.kind == "reacted" for t in turns) / 2
    assert episode.unmatched == (episode.decisions if name == "reactive_planner" else 0)
    assert episode == run_episode(env, agent, seed=2, start=0, max_decisions=6)


def test_an_agent_that_does_not_know_how_to_act_stays(env: PathFinding) -> None:
    config = replace(find_config("tuned"), no_match="nearest")
    agent = make_agent("reactive_planner", env.scene.robot.layout, config)
    episode = run_episode(env, agent, seed=2, start=0)
    assert (episode.decisions, episode.unmatched, episode.reached) == (0, 1, False)
    assert not episode.strict
