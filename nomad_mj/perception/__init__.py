"""From range readings to the situation: pure functions over leading batch dimensions."""

from nomad_mj.perception.certainty_grid import GridSpec, cell_centres, certainty_grid
from nomad_mj.perception.coarse_coding import code_grid, code_signal, pool
from nomad_mj.perception.situation import Percept, SituationSpec, attraction_force, perceive

__all__ = [
    "GridSpec",
    "Percept",
    "SituationSpec",
    "attraction_force",
    "cell_centres",
    "certainty_grid",
    "code_grid",
    "code_signal",
    "perceive",
    "pool",
]
