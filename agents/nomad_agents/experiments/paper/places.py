"""Fig 9: what the learnt actions are worth with another goal, and in another room."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

import nomad_mj
from nomad_agents.experiments.experiment import (
    LEARNER,
    PLANNER,
    STRAIGHT,
    Experiment,
    Showcase,
    Study,
    TableRow,
    Verdict,
    column,
)
from nomad_agents.experiments.lattice import judge_actions, lattice
from nomad_agents.experiments.learnt import (
    acting_agent,
    trained_agent,
)
from nomad_agents.experiments.pictures import LATTICE, action_map, spread_starts, way
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.studies.measures import assess, episode_rows
from nomad_agents.studies.runs import Result, Row, Run
from nomad_mj.envs import PathFinding
from nomad_mj.errors import NomadError
from nomad_mj.scene import build_scene

SHOWN = 8


class Place(NamedTuple):
    """Another room (that of the study if empty), another goal [m] (the room's own if None)."""

    room: str = ""
    goal: tuple[float, float] | None = None


PLACES = {
    "goal (2.4, 4.2)": Place(goal=(2.4, 4.2)),
    "goal (5, 2)": Place(goal=(5.0, 2.0)),
    "clutter": Place(room="clutter"),
}


@dataclass(frozen=True)
class PlaceRun(Run):
    """A run whose case says where it is done; `room` is where its agent has learnt."""

    def rooms(self) -> tuple[str, ...]:
        """Return the room of the agent and that of the place."""
        other = PLACES[self.case].room
        return (self.room, other) if other else (self.room,)


@lru_cache
def _fits(study: Study, place: Place) -> bool:
    """Return whether there is such a place, and whether it is another one than the study's."""
    room = place.room or study.room
    if room == study.room and place.goal is None:
        return False
    try:
        build_scene(room, study.robot, goal=place.goal)
    except NomadError:
        return False
    return True


def plan_places(
    experiment: Experiment, study: Study, places: Sequence[str], costly: Sequence[str] = ()
) -> list[Run]:
    """Return the runs at those of some places that suit the study."""
    cases = [case for case in places if _fits(study, PLACES[case])]
    runs = experiment.plan_runs(study, cases, (STRAIGHT, PLANNER), costly=costly)
    return [PlaceRun(**asdict(run)) for run in runs]


def open_place(run: Run) -> PathFinding:
    """Return the other place of a run's case."""
    place = PLACES[run.case]
    return nomad_mj.load(
        "path_finding", room=place.room or run.room, robot=run.robot, goal=place.goal
    )


def place_pictures(env: PathFinding, agent: ReactivePlanner, run: Run) -> tuple[Row, Row]:
    """Return what the map of actions is worth, and what is drawn of a place."""
    actions = action_map(env, agent, lattice(env.scene, LATTICE), run.seed)
    held = {"actions": actions, "goal": env.scene.arena.goal.tolist()}
    return judge_actions(env, actions), {**held, "room": PLACES[run.case].room or run.room}


def cases_of(results: Sequence[Result]) -> list[str]:
    """Return the places that there are results of."""
    return list(dict.fromkeys(result.run.case for result in results))


def verdict_of(claims: Sequence[bool], reason: str) -> Verdict:
    """Return that the claim holds if all its parts do, and in part if any does."""
    if all(claims):
        return Verdict("holds", reason)
    return Verdict("holds in part" if any(claims) else "does not hold", reason)


class OtherPlaces(Experiment):
    """Fig 9."""

    name = "fig9"
    title = "Another goal, another room: before adapting"
    claim = (
        "In a new environment the robot handles some situations correctly, applies unsuitable "
        "rules in others, and does not know how to act in most of it."
    )
    source = "section 4, Fig 9"
    table = tuple(
        TableRow(f"{case}: {label}", key, case, digits=3)
        for case in PLACES
        for label, key in (
            ("places whose situation is known", "known"),
            ("suitable actions among these", "known_suitable"),
            ("goal reached by reactions alone", "success_alone"),
            ("goal reached", "success_rate"),
        )
    )

    def runs(self, study: Study) -> list[Run]:
        """Return a run for each place, agent and seed."""
        return plan_places(self, study, list(PLACES))

    def work(self, run: Run, folder: Path) -> Result:
        """Send an agent that learnt one place to another."""
        result = Result(run, {})
        with open_place(run) as env:
            agent = acting_agent(run, folder, env)
            row, trials = assess(env, agent, run.seed)
            result.episodes = episode_rows(trials)
            result.row |= row
            if isinstance(agent, ReactivePlanner):
                judged, pictures = place_pictures(env, agent, run)
                result.row |= judged
                if run.seed == 0:
                    result.pictures = {**pictures, "ways": [way(t) for t in trials[:SHOWN]]}
                agent.config = replace(agent.config, no_match="stay")
                alone, _ = assess(env, agent, run.seed)
                result.row["success_alone"] = alone["success_rate"]
        return result

    def judge(self, results: Sequence[Result]) -> Verdict:
        """Ask at each place for situations that are known, and for many that are not."""
        claims: list[bool] = []
        told: list[str] = []
        for case in cases_of(results):
            known = float(np.median(column(results, "known", case)))
            suits = column(results, "known_suitable", case)
            suitable = float(np.median(suits[np.isfinite(suits)])) if known else 0.0
            claims += [known < 0.5, 0.2 <= suitable <= 0.95]
            told.append(f"{known:.0%} in {case}, {suitable:.0%} of the actions there suitable")
        return verdict_of(claims, f"the situations that are known: {'; '.join(told)}")

    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Show what the robot does where it has not learnt."""
        case = self.runs(study)[0].case
        run = Run(self.name, case, LEARNER, study.config, study.room, study.robot, 0)
        agent, _ = trained_agent(run, folder)
        env = open_place(run)
        return Showcase(env, agent, spread_starts(env, 3), subtitle=f"{case}, not adapted")
