"""How each agent comes to be: by learning, or at once.

A new one is a class derived from `Learner` and a line where `LEARNERS` is made.
"""

from collections.abc import Mapping

from nomad_agents.deep import LEARNERS as DEEP
from nomad_agents.learners.kinds import DeepLearner, ReactionLearner, Untaught, unaided
from nomad_agents.learners.learner import Examiner, Learner, Lesson, Opener, Unexamined
from nomad_agents.reactive_planner import ReactivePlanner
from nomad_agents.registry import AGENTS
from nomad_mj.errors import UnknownNameError

__all__ = [
    "LEARNERS",
    "DeepLearner",
    "Examiner",
    "Learner",
    "Lesson",
    "Opener",
    "ReactionLearner",
    "Unexamined",
    "Untaught",
    "find_learner",
    "unaided",
    "usual_agents",
]

LEARNERS: Mapping[str, Learner] = {
    each.name: each
    for each in (
        *(Untaught(name) for name in AGENTS if name != ReactivePlanner.name),
        ReactionLearner(),
        *(DeepLearner(name, settings()) for name, settings in DEEP.items()),
    )
}


def usual_agents() -> tuple[str, ...]:
    """Return all agents that need no hours, the learners among them in all their variants."""
    return tuple(
        f"{each.name}:{variant}" if each.learns else each.name
        for each in LEARNERS.values()
        if not each.deep
        for variant in (each.variants if each.learns else each.variants[:1])
    )


def find_learner(spec: str) -> tuple[Learner, str]:
    """Return the learner and the variant that ``NAME`` or ``NAME:VARIANT`` means.

    Raises
    ------
    UnknownNameError
        There is no such agent or variant.
    """
    name, _, variant = spec.partition(":")
    if name not in LEARNERS:
        raise UnknownNameError("agent", name, LEARNERS)
    learner = LEARNERS[name]
    variant = variant or learner.variants[0]
    if variant not in learner.variants:
        raise UnknownNameError(f"variant of {name}", variant, learner.variants)
    return learner, variant
