"""How far learning is: the same unseen starts, driven from now and then while an agent learns.

They are not the starts of the final evaluation, nor of training, and an environment of their own
is driven in: learning goes on to the same bits whether it is checked or not.
"""

from collections.abc import Sequence

from nomad_agents.agent import Agent
from nomad_agents.evaluation import draw_starts, evaluate, summarise
from nomad_agents.studies.runs import Row
from nomad_mj.envs import PathFinding

CHECK_SEED = 2_000_000  # far from the seeds that train and from that of the final evaluation
MASTERED = 0.9  # of the starts
_FIRST = 25  # decisions of learning before the first check of what was learnt
_CLOSE, _APART = 1.4, 2.0  # decisions until the next check, as a factor
_KINDS = ("", "unaided_")  # prefixes of what is told of either agent
_RATES = ("success_rate", "strict_success_rate", "spl")


class Checks:
    """Checks of one run.

    Parameters
    ----------
    env : PathFinding
        To drive in.
    starts : int
        How many to drive from.
    seed : int
        Of the run: decides the noise.
    decisions : int
        After which an episode is given up.
    whole : bool
        Whether to go on, and closer together, when 90 % are mastered: for a whole curve.

    Attributes
    ----------
    whole : bool
        As given.
    latest : float
        Decisions of learning at the newest check; -1 before the first.
    curve : list of dict
        One entry a check: ``decisions`` and ``sim_s`` of learning so far, what learning has cost
        so far, and ``success_rate``, ``strict_success_rate`` and ``spl``; the same with
        ``unaided_`` of an agent that has to do without what taught it, where there is such.
    """

    def __init__(
        self, env: PathFinding, starts: int, seed: int, decisions: int, *, whole: bool
    ) -> None:
        self._env = env
        self._starts = draw_starts(env, starts, CHECK_SEED)
        self._seed = CHECK_SEED + seed
        self._decisions = decisions
        self.whole = whole
        self._next = 0.0
        self.latest = -1.0
        self._mastered: set[str] = set()
        self.curve: list[Row] = []

    def due(self, decisions: int) -> bool:
        """Return whether a check is due after so many decisions of learning."""
        return decisions >= self._next

    def take(self, agent: Agent, unaided: Agent | None = None, **learning: float) -> None:
        """Drive from all starts.

        Parameters
        ----------
        agent, unaided : Agent
            As it is; and without what taught it, if anything did. Neither learns.
        **learning
            ``decisions``, ``sim_s`` and what else learning has taken so far.
        """
        rates: Row = {}
        for kind, each in zip(_KINDS, (agent, unaided), strict=True):
            if each is None or (kind in self._mastered and not self.whole):
                continue
            trials = evaluate(self._env, each, self._starts, self._seed, self._decisions)
            summary = summarise(self._env, trials)
            rates |= {f"{kind}{key}": summary[key] for key in _RATES}
            if summary["success_rate"] >= MASTERED:
                self._mastered.add(kind)
        if rates:
            self.curve.append(learning | rates)
        factor = _CLOSE if self.whole else _APART
        self.latest = learning["decisions"]
        self._next = max(_FIRST, self.latest * factor)


def until_mastered(curve: Sequence[Row]) -> Row:
    """Return decisions and simulated seconds until 90 % of the starts were reached; None if never.

    Returns
    -------
    dict
        ``decisions_to_90``, ``sim_s_to_90``, and the same with ``unaided_`` where it was checked.
    """
    row: Row = {}
    for kind in _KINDS:
        rated = [entry for entry in curve if f"{kind}success_rate" in entry]
        if not rated:
            continue
        good = [entry for entry in rated if entry[f"{kind}success_rate"] >= MASTERED]
        for key in ("decisions", "sim_s"):
            row[f"{kind}{key}_to_90"] = good[0][key] if good else None
    return row
