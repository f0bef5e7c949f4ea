"""The benchmark's page: one file that needs no network and no other file."""

from nomad_agents.benchmark.page.page import Figure, Part, write_page

__all__ = ["Figure", "Part", "write_page"]
