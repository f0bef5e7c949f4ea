"""What all tests share: the `gl` marker and how hypothesis runs."""

import os

import pytest
from hypothesis import settings

from nomad_mj._gl import gl_report

# A deadline measures the machine's other work, not the code.
settings.register_profile("local", deadline=None)
settings.register_profile("ci", deadline=None, derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "local")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "gl: draws a picture; skipped where no OpenGL works")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    report = gl_report()
    if report.works:
        return
    skip = pytest.mark.skip(reason=report.message)
    for item in items:
        if item.get_closest_marker("gl"):
            item.add_marker(skip)
