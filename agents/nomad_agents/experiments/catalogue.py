"""All experiments by name."""

from nomad_agents.experiments.experiment import Experiment

EXPERIMENTS: dict[str, Experiment] = {}
