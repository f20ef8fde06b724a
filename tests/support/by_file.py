"""A pytest plugin: how tests are shared out when several run side by side.

A plugin, for a conftest.py is not read when only the notebooks are to run, and their cells have to stay together.
"""

from __future__ import annotations

import os

import pytest
from xdist.scheduler import LoadScopeScheduling

LONG = ("test_notebooks_in_browser.py", "test_desk_in_browser.py")
"""The files whose tests come first and are shared out one by one: each takes longer than most files."""


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes longest, so that in the end no core waits for another."""
    items.sort(key=lambda item: (item.path.name not in LONG, item.get_closest_marker("browser") is None))


@pytest.hookimpl(tryfirst=True)
def pytest_xdist_auto_num_workers() -> int:
    """One more than there are cores: tests often wait, for a discovery, or for a process to end."""
    return (os.cpu_count() or 1) + 1


class _ByFile(LoadScopeScheduling):
    """Keeps the tests of a file together, and the cells of a notebook, in their order."""

    def _split_scope(self, nodeid: str) -> str:
        file, *_ = nodeid.split("::")
        return nodeid if file.endswith(LONG) else file


@pytest.hookimpl(tryfirst=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> LoadScopeScheduling:
    """Share the tests out by files."""
    return _ByFile(config, log)
