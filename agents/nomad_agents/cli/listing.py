"""``nomad-mj list``."""

from dataclasses import dataclass

from rich.console import Console
from rich.table import Table

import nomad_mj
from nomad_agents.cli.common import print_json
from nomad_agents.deep import LEARNERS
from nomad_agents.reactive_planner import CONFIGS, ReactivePlanner
from nomad_agents.registry import AGENTS
from nomad_mj.envs import TASKS


@dataclass(frozen=True)
class List:
    """List the rooms, robots, tasks, agents, learners and configurations that there are."""

    json: bool = False
    """Print one line of JSON instead of a table."""

    def run(self) -> int:
        """Print them; return the exit code."""
        found = {
            "rooms": [*nomad_mj.list_rooms()],
            "robots": [*nomad_mj.list_robots()],
            "tasks": [*TASKS],
            "agents": [*AGENTS],
            "learners": [ReactivePlanner.name, *LEARNERS],
            "configs": [*CONFIGS],
        }
        if self.json:
            print_json(found)
            return 0
        table = Table(show_header=False)
        for kind, names in found.items():
            table.add_row(kind, "\n".join(names))
        Console().print(table)
        return 0
