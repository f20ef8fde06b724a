"""A pytest plugin: how tests are shared out when several run side by side.

A plugin, for a conftest.py is not read when only the notebooks are to run, and their cells have to stay together.
"""

from __future__ import annotations

import os
import re

import pytest
from xdist.scheduler import LoadScopeScheduling

SHARED_OUT = "test_notebooks_in_browser.py"
"""The file whose tests are shared out: each takes longer than most files."""

DESKS = 2
"""How many workers share them. Each has a JupyterLab and a browser of its own: no more than two cores can bear."""

SLOW = (
    *(SHARED_OUT, "test_desk_in_browser.py"),
    *("test_hostile_names.py", "test_ros2_commands.py", "test_soak.py", "test_lab.py", "test_two_machines.py"),
    *("test_steps.py", "test_processes.py", "test_host.py", "test_contain.py", "test_mutants.py", "test_check.py"),
)
"""The files that come first, and after them the notebooks: half a minute each and more, most of which they wait."""

MORE_THAN_CORES = 1  # workers, for tests often wait: for a discovery, a duration, or a process to end


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with what takes longest, so that in the end no core waits for another."""

    def turn(item: pytest.Item) -> tuple[int, bool]:
        by_name = SLOW.index(item.path.name) if item.path.name in SLOW else len(SLOW)
        return by_name, item.path.suffix != ".ipynb" and item.get_closest_marker("browser") is None

    items.sort(key=turn)


@pytest.hookimpl(tryfirst=True)
def pytest_xdist_auto_num_workers() -> int:
    """Say how many tests run side by side."""
    return (os.cpu_count() or 1) + MORE_THAN_CORES


class _ByFile(LoadScopeScheduling):
    """Keeps the tests of a file together, and the cells of a notebook, in their order."""

    def _split_scope(self, nodeid: str) -> str:
        file, *_ = nodeid.split("::")
        step = re.search(r"\[(\d+)_", nodeid) if file.endswith(SHARED_OUT) else None
        return f"{file}::{int(step[1]) % DESKS}" if step else file


@pytest.hookimpl(tryfirst=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> LoadScopeScheduling:
    """Share the tests out by files."""
    return _ByFile(config, log)
