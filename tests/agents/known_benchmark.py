"""Made-up results of a benchmark, of any agents in any sets."""

from collections.abc import Sequence

import numpy as np
from nomad_agents.benchmark.run import BenchmarkRun
from nomad_agents.learners import find_learner
from nomad_agents.studies.runs import Result, Row


def made_up_run(
    tasks: str, case: str, agent: str, seed: int, *, robot: str = "nomad200", whole: bool = True
) -> BenchmarkRun:
    learner, variant = find_learner(agent)
    return BenchmarkRun(
        experiment=tasks,
        case=case,
        agent=learner.name,
        config=variant,
        room="paper_room",
        robot=robot,
        seed=seed,
        condition="usual",
        time_limit=150.0,
        decisions=100,
        starts=25,
        check_starts=10,
        budget=20_000,
        whole_curves=whole,
    )


def made_up(
    tasks: Sequence[str], agents: Sequence[str], *, cases: int = 2, seeds: int = 3
) -> list[Result]:
    """Return results in which the agents are the better the later they come."""
    results: list[Result] = []
    for seed in range(seeds):
        for number, name in enumerate(tasks):
            for case in range(cases):
                for place, agent in enumerate(agents):
                    rng = np.random.default_rng([number, case, place, seed])
                    run = made_up_run(name, str(case), agent, seed)
                    good = float(np.clip((place + 1) / len(agents) - 0.1 * rng.random(), 0, 1))
                    results.append(_result(run, good, rng))
    return results


def _result(run: BenchmarkRun, good: float, rng: np.random.Generator) -> Result:
    row: Row = {
        "episodes": 25,
        "success_rate": round(good, 2),
        "strict_success_rate": round(0.9 * good, 2),
        "spl": 0.95 * good,
        "path_ratio_median": 1.05,
        "min_clearance_m": 0.03,
        "virtual_collisions": 4,
        "bumper_contacts": 0,
        "mean_time_s": 30.0,
        "barn_score": 0.25 * good,
    }
    result = Result(run, row, [{"reached": True}], machine={"wall_s": 2.0, "learn_wall_s": 1.0})
    if find_learner(run.agent)[0].learns:
        row |= {"learn_decisions": 900, "learn_solved_all": True}
        row |= {"decisions_to_90": 400 if good > 0.5 else None}
        pace = rng.uniform(0.5, 1.5) * (100 if run.agent == "reactive_planner" else 3000)
        for decisions in np.unique(np.geomspace(25, 30 * pace, 20).astype(int)).tolist():
            rate = good * (1 - np.exp(-decisions / pace))
            entry = {"decisions": decisions, "success_rate": rate, "sim_s": 5.0 * decisions}
            if run.agent == "reactive_planner":
                entry |= {"success_rate": good, "unaided_success_rate": rate}
            result.curve.append(entry)
    return result
