"""The report: one page that shows every experiment, and needs nothing but itself."""

from nomad_agents.experiments.report.page import write_report
from nomad_agents.experiments.report.provenance import provenance
from nomad_agents.experiments.report.section import (
    Captioned,
    NoVideo,
    Section,
    Video,
)

__all__ = ["Captioned", "NoVideo", "Section", "Video", "provenance", "write_report"]
