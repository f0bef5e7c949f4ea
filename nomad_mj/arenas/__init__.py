"""What a room offers: its goal and starts, its floor plan, free places and shortest paths."""

from nomad_mj.arenas.arena import Arena, check_arena
from nomad_mj.arenas.floor_plan import FloorPlan
from nomad_mj.arenas.geodesic import Geodesic
from nomad_mj.arenas.names import goal_site
from nomad_mj.arenas.nearby import Nearby, near_model

__all__ = ["Arena", "FloorPlan", "Geodesic", "Nearby", "check_arena", "goal_site", "near_model"]
