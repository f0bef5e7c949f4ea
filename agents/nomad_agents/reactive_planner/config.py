"""Parameters of the reactive planner: Table 1 of the paper, and the readings it needs."""

import math
from dataclasses import dataclass, field, replace
from typing import Literal, get_args

from nomad_mj.errors import ConfigError
from nomad_mj.limits import MOST, TINY, require
from nomad_mj.motion import ActionSpec
from nomad_mj.perception import SituationSpec

NoMatch = Literal["plan", "nearest", "stay"]
NO_MATCHES: tuple[NoMatch, ...] = get_args(NoMatch)


@dataclass(frozen=True)
class PlannerConfig:
    """The one-step planner.

    Attributes
    ----------
    k_length, k_rep : float
        Weights of the distance to the goal and of the repulsion (Eq 19).
    k_clear : float
        Distances to cells count as no shorter [m] (Eq 20).
    k_alpha : float
        Half the angle around the goal's direction in which cells repel [rad].
    occupied : float
        Above this probability a cell bars the way; those that no cone sees do not. Above 1: none.
    margin : float
        The planned way keeps this much off the centres of such cells [m]: half a cell, and the
        security distance, nearer than which a move is stopped.
    """

    k_length: float = 0.75
    k_rep: float = 0.25
    k_clear: float = 0.1
    k_alpha: float = math.radians(45)
    occupied: float = 0.5
    margin: float = 0.15

    def __post_init__(self) -> None:
        require(
            self,
            k_length=(0.0, MOST),
            k_rep=(0.0, MOST),
            k_clear=(TINY, MOST),
            k_alpha=(0.0, math.pi),
            occupied=(0.0, MOST),
            margin=(0.0, MOST),
        )


@dataclass(frozen=True)
class ReactivePlannerConfig:
    """Everything the reactive planner can be told.

    Attributes
    ----------
    k_dist : float
        Situations farther than this from an exemplar do not match it (Eq 9).
    k_ind : float
        Categories within this of the highest activation compete by their value.
    k_z : float
        Errors below -k_z call for another categorisation; also tells categories apart.
    beta : float
        Slope of the action units (Eq 16).
    xi : float
        Weight of the newest error in a category's trace (Eq 14).
    k_sigma, sigma_floor : float
        Exploration per trace (Eq 13), and its least value: without one Eq 23 explodes.
    epsilon : float
        Rate at which exemplars move towards situations (Eq 21).
    alpha_reward, alpha_penalty : float
        Rates of the action weights (Eq 22), on better and on worse than expected.
    eta_reward, eta_penalty : float
        Rates of the categories' values (Eq 18), likewise.
    remember_good_actions : bool
        Section 5: categories remember their best action and are taught it.
    no_match : "plan", "nearest" or "stay"
        What an agent that does not learn does where no exemplar matches: ask the planner as
        while learning, trust the nearest exemplar, or admit that it does not know.
    planner : PlannerConfig
        The planner.
    situation : SituationSpec
        The coding of situations.
    action : ActionSpec
        Lengths of moves.
    """

    k_dist: float = 1.0
    k_ind: float = 0.1
    k_z: float = 0.5
    beta: float = 0.4
    xi: float = 0.75
    k_sigma: float = 1.0
    sigma_floor: float = 0.02
    epsilon: float = 0.1
    alpha_reward: float = 0.2
    alpha_penalty: float = 0.02
    eta_reward: float = 0.75
    eta_penalty: float = 0.075
    remember_good_actions: bool = False
    no_match: NoMatch = "plan"
    planner: PlannerConfig = field(default_factory=PlannerConfig)
    situation: SituationSpec = field(default_factory=SituationSpec)
    action: ActionSpec = field(default_factory=ActionSpec)

    def __post_init__(self) -> None:
        require(
            self,
            **dict.fromkeys(("k_ind", "k_z", "k_sigma"), (0.0, MOST)),
            k_dist=(TINY, MOST),
            **dict.fromkeys(("beta", "sigma_floor"), (TINY, MOST)),
            **dict.fromkeys(("xi", "epsilon"), (0.0, 1.0)),
            **dict.fromkeys(("alpha_reward", "alpha_penalty"), (0.0, 1.0)),
            **dict.fromkeys(("eta_reward", "eta_penalty"), (0.0, 1.0)),
        )
        if self.no_match not in NO_MATCHES:
            known = ", ".join(NO_MATCHES)
            raise ConfigError(f"no_match {self.no_match!r}: must be one of {known}")


FAITHFUL = ReactivePlannerConfig()
TUNED = replace(
    FAITHFUL,
    k_ind=0.02,
    planner=replace(FAITHFUL.planner, margin=0.25),
    situation=replace(FAITHFUL.situation, circular=True),
)
CONFIGS: dict[str, ReactivePlannerConfig] = {"faithful": FAITHFUL, "tuned": TUNED}
