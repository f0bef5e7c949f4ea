"""Look at a robot in a room and drive it by hand, in a window or in a browser."""

from nomad_agents.viewer.browser import view_in_browser
from nomad_agents.viewer.session import Session
from nomad_agents.viewer.window import has_screen, view_in_window

__all__ = ["Session", "has_screen", "view_in_browser", "view_in_window"]
