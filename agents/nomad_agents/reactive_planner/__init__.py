"""The paper's agent: reactions learnt from plans and from reinforcement."""

from nomad_agents.reactive_planner.agent import ReactivePlanner
from nomad_agents.reactive_planner.config import (
    CONFIGS,
    FAITHFUL,
    TUNED,
    PlannerConfig,
    ReactivePlannerConfig,
)
from nomad_agents.reactive_planner.network import Match, Network
from nomad_agents.reactive_planner.planner import ACTIONS, Plan, estimate_value, plan

__all__ = [
    "ACTIONS",
    "CONFIGS",
    "FAITHFUL",
    "TUNED",
    "Match",
    "Network",
    "Plan",
    "PlannerConfig",
    "ReactivePlanner",
    "ReactivePlannerConfig",
    "estimate_value",
    "plan",
]
