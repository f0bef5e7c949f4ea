"""From range readings to the situation: pure functions over leading batch dimensions."""

from nomad_mj.perception.certainty_grid import GridSpec, cell_centres, certainty_grid
from nomad_mj.perception.coarse_coding import code_grid, code_signal, pool
from nomad_mj.perception.coded_percept import (
    OBSERVATIONS,
    Observation,
    code_percept,
    code_ranges,
    coded_size,
)
from nomad_mj.perception.situation import Percept, SituationSpec, attraction_force, perceive

__all__ = [
    "OBSERVATIONS",
    "GridSpec",
    "Observation",
    "Percept",
    "SituationSpec",
    "attraction_force",
    "cell_centres",
    "certainty_grid",
    "code_grid",
    "code_percept",
    "code_ranges",
    "code_signal",
    "coded_size",
    "perceive",
    "pool",
]
