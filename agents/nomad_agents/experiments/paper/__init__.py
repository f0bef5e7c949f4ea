"""The paper's experiments, one a file, by their names on the command line.

A new one is a class in a file of its own here, and a line below.
"""

from nomad_agents.experiments.experiment import Experiment
from nomad_agents.experiments.paper.ablations import Ablations
from nomad_agents.experiments.paper.actions import Actions
from nomad_agents.experiments.paper.adapting import Adapting
from nomad_agents.experiments.paper.concave import Concave
from nomad_agents.experiments.paper.intensity import NoIntensity
from nomad_agents.experiments.paper.learning import Learning
from nomad_agents.experiments.paper.moving import GoalMoves, ObstaclesMove
from nomad_agents.experiments.paper.noise import Noise
from nomad_agents.experiments.paper.odometry import WrongOdometry
from nomad_agents.experiments.paper.places import OtherPlaces
from nomad_agents.experiments.paper.robots import OtherRobots
from nomad_agents.experiments.paper.timing import Timing

EXPERIMENTS: dict[str, Experiment] = {
    each.name: each
    for each in (
        Learning(),
        Actions(),
        WrongOdometry(),
        OtherPlaces(),
        Adapting(),
        GoalMoves(),
        ObstaclesMove(),
        Concave(),
        NoIntensity(),
        Noise(),
        Timing(),
        OtherRobots(),
        Ablations(),
    )
}
EXTRA = (OtherRobots.name, Ablations.name)  # beyond the paper, and long: by their names only
