"""Mazes of labmaze, which dm_control brings along."""

import labmaze
import numpy as np

from nomad_mj.errors import ConfigError
from nomad_mj.rooms.occupancy import FREE, OCCUPIED, Occupancy, room_of_map
from nomad_mj.rooms.room import Room

CELL = 1.2
"""How wide passages and walls are [m]; the robot is 0.53 m wide."""


def maze_room(seed: int, difficulty: float = 0.5) -> Room:
    """Return a maze with small open places in it, still without starts.

    Parameters
    ----------
    seed : int
        Of the maze, 0 to 2**31 - 1.
    difficulty : float
        From 0, 7 x 7 cells, to 1, 19 x 19.

    Raises
    ------
    ConfigError
        A seed or difficulty outside these.
    """
    if not 0 <= seed < 2**31:
        raise ConfigError(f"seed {seed}: must be 0 to {2**31 - 1}")
    if not 0 <= difficulty <= 1:
        raise ConfigError(f"difficulty {difficulty:g}: must be 0 to 1")
    cells = 7 + 2 * round(6 * difficulty)
    maze = labmaze.RandomMaze(height=cells, width=cells, random_seed=seed)
    walls = np.array([list(row) for row in str(maze.entity_layer).splitlines()]) == "*"
    grid = np.where(walls, OCCUPIED, FREE).astype(np.uint8)
    return room_of_map(Occupancy(np.flipud(grid), CELL), f"maze_{seed}")
