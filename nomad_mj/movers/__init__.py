"""Goals and obstacles that move: how they do, which bodies they are, and the rules they keep."""

from nomad_mj.movers.bodies import Moving, MovingBody, read_moving
from nomad_mj.movers.drift import Drift, MovingGoal, MovingObstacles
from nomad_mj.movers.movers import Movers, find_room_for
from nomad_mj.movers.spec import add_obstacles, place_goal
from nomad_mj.movers.stroll import Stroll, Walker, Walkers
from nomad_mj.movers.walk import Walk

__all__ = [
    "Drift",
    "Movers",
    "Moving",
    "MovingBody",
    "MovingGoal",
    "MovingObstacles",
    "Stroll",
    "Walk",
    "Walker",
    "Walkers",
    "add_obstacles",
    "find_room_for",
    "place_goal",
    "read_moving",
]
