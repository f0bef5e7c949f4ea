"""Training an agent within a study: what it took, and the curve of its learning."""

from collections.abc import Callable
from dataclasses import asdict

from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.studies.runs import Row
from nomad_agents.training import Training, TrainingConfig, train, training_report
from nomad_mj.envs import PathFinding

_PER_PASS = ("decisions", "reactions", "plannings", "virtual_collisions", "bumper_contacts")


def learn(
    env: PathFinding,
    agent: ReactivePlanner,
    config: TrainingConfig,
    watch: Callable[[Training], None] | None = None,
) -> tuple[Row, list[Row]]:
    """Train an agent; return what it took and one entry of its learning curve a pass.

    `watch` is called after each episode.

    Returns
    -------
    dict
        `training_report`, names beginning with ``learn_``; ``learn_solved_all``: whether the last
        test solved every start.
    list of dict
        Counts since the beginning, and starts solved in the test after the pass. How many are
        solved is told here and there of `whole_tests` alone.
    """
    curve: list[Row] = []
    before = agent.plannings
    starts = len(config.chosen(len(env.scene.arena.starts)))

    def after_episode(training: Training) -> None:
        if training.next_start == 0 and not training.testing:  # a test has just ended
            held = asdict(training)
            entry = {name: held[name] for name in _PER_PASS}
            entry["plannings"] -= before
            entry |= {"pass": len(curve) + 1, "starts": starts}
            if config.whole_tests:
                entry["solved"] = training.solved
            curve.append(entry)
        if watch is not None:
            watch(training)

    training = train(env, agent, config, Training(), after_episode)
    report = training_report(env, agent, training) | {"starts": starts}
    report["plannings"] -= before
    del report["wall_s"]  # differs from run to run
    if not config.whole_tests:
        del report["solved"]
    report["solved_all"] = training.done
    return {f"learn_{name}": value for name, value in report.items()}, curve
