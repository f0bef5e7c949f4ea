"""What an experiment is: runs, the numbers asked of them, and a verdict on the paper's claim."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from nomad_agents.agent import Agent
from nomad_agents.baselines import Planner, Straight
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.studies.runs import Result, Run
from nomad_mj.envs import PathFinding
from nomad_mj.tasks import Start
from nomad_mj.types import FloatArray

LEARNER, STRAIGHT, PLANNER = ReactivePlanner.name, Straight.name, Planner.name
# Baselines learn nothing: only the noise of their sensors differs between runs. Who stands before a
# wall until time is up costs more than who learns, and does so with any seed.
BASELINE_SEEDS = {STRAIGHT: 1, PLANNER: 3}
COSTLY_SEEDS = 5  # of cases that take minutes each: twenty of them would take half of the time


@dataclass(frozen=True)
class Study:
    """What the user chose: names of configuration, room and robot, and how many seeds."""

    config: str
    room: str
    robot: str
    seeds: int


class TableRow(NamedTuple):
    """A line of an experiment's table.

    Attributes
    ----------
    label : str
        What is counted, with its unit.
    key : str
        Its name in the runs' rows.
    case : str
        The case whose runs it is taken from.
    paper : str
        What the paper says, if anything.
    digits : int
        Decimals.
    total : bool
        Whether to add the runs up and say of how many ("19 of 20") instead of showing their
        spread; for what a run either does or does not.
    """

    label: str
    key: str
    case: str = ""
    paper: str = ""
    digits: int = 0
    total: bool = False


class Verdict(NamedTuple):
    """Whether the paper's claim holds, and the numbers that say so, in a sentence."""

    holds: Literal["holds", "holds in part", "does not hold"]
    reason: str


class Showcase(NamedTuple):
    """What a video shows; whoever asked for it closes `env`.

    Attributes
    ----------
    env, agent
        As they are in the case shown.
    starts : sequence
        As of `PathFinding.reset`, an episode from each.
    learning : bool
        Whether the agent goes on learning in it.
    subtitle : str
        What case this is.
    """

    env: PathFinding
    agent: Agent
    starts: Sequence[Start]
    learning: bool = False
    subtitle: str = ""


class Experiment(ABC):
    """One experiment.

    Attributes
    ----------
    name : str
        As on the command line.
    title, claim, source : str
        A heading; what the paper claims; where in the paper.
    table : tuple of TableRow
        What to tell of it.
    needs_trained : bool
        Whether its runs begin with the agents that have learnt the room.
    shows_trained : bool
        Whether its video shows the first of these agents, though its runs do not need them.
    """

    name: str
    title: str
    claim: str
    source: str
    table: tuple[TableRow, ...]
    needs_trained: bool = True
    shows_trained: bool = False

    @abstractmethod
    def runs(self, study: Study) -> list[Run]:
        """Return the runs that a study is made of."""

    @abstractmethod
    def work(self, run: Run, folder: Path) -> Result:
        """Do one run; trained agents are found in, or added to, `folder`."""

    @abstractmethod
    def judge(self, results: Sequence[Result]) -> Verdict:
        """Return whether the claim holds."""

    @abstractmethod
    def showcase(self, study: Study, folder: Path) -> Showcase:
        """Return what a video of the experiment shows, when its runs are on file."""

    def plan_runs(
        self,
        study: Study,
        cases: Sequence[str],
        baselines: Sequence[str],
        room: str = "",
        costly: Sequence[str] = (),
    ) -> list[Run]:
        """Return a run for each case, agent and seed; fewer seeds of baselines and costly cases."""

        def seeds(case: str, agent: str) -> int:
            most = BASELINE_SEEDS.get(agent, COSTLY_SEEDS if case in costly else study.seeds)
            return min(study.seeds, most)

        return [
            Run(self.name, case, agent, study.config, room or study.room, study.robot, seed)
            for case in cases
            for agent in (LEARNER, *baselines)
            for seed in range(seeds(case, agent))
        ]


def column(results: Sequence[Result], key: str, case: str = "", agent: str = LEARNER) -> FloatArray:
    """Return one number of each run of an agent, (runs,), NaN where it has none.

    Parameters
    ----------
    results : sequence of Result
        Of one experiment.
    key, case, agent : str
        Which number; of which case, of all if empty; of which agent.
    """
    values = [
        result.row[key]
        for result in results
        if result.run.agent == agent and (not case or result.run.case == case) and key in result.row
    ]
    return np.array([np.nan if value is None else float(value) for value in values])
