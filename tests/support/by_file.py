"""A pytest plugin: how tests are shared out when several run side by side.

A plugin, for a conftest.py is not read when only the notebooks are to run, and their cells have to stay together.
"""

import os
import re

import pytest
from xdist.scheduler import LoadScopeScheduling

SHARED_OUT = {"test_notebooks_in_browser.py": 2, "test_cells_twice.py": 9}
"""Files whose tests are about one notebook each, and among how many workers they are shared at most. Of those in a
browser each worker has a JupyterLab and a browser of its own: no more than two cores can bear."""

LONG = {
    "test_cells_twice.py",
    "test_drive.py",
    "test_two_machines.py",
    "test_check.py",
    "test_processes.py",
    "test_behaviour.py",
    "test_tables.py",
}
"""Files that keep a worker busy for long. If one of them came last, the other workers would wait for it."""

MORE_THAN_CORES = 1  # workers, for tests often wait: for a discovery, a duration, or a process to end


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the notebooks and what is in a browser, then the long files, so that all workers end together."""
    items.sort(key=_turn)


def _turn(item: pytest.Item) -> tuple[int, int]:
    """Return a test's place in the order. Of the notebooks, larger files come first: they take longer."""
    if item.path.suffix == ".ipynb":
        return 0, -item.path.stat().st_size
    if item.get_closest_marker("browser"):
        return 0, 0
    return (1 if item.path.name in LONG else 2), 0


@pytest.hookimpl(tryfirst=True)
def pytest_xdist_auto_num_workers() -> int:
    """Say how many tests run side by side."""
    return (os.cpu_count() or 1) + MORE_THAN_CORES


class _ByFile(LoadScopeScheduling):
    """Keeps the tests of a file together, with each RMW its own, and the cells of a notebook, in their order."""

    def _split_scope(self, nodeid: str) -> str:
        file, *_ = nodeid.split("::")
        workers, step = SHARED_OUT.get(os.path.basename(file)), re.search(r"\[(\d+)_", nodeid)  # noqa: PTH119
        if workers and step:
            return f"{file}::{int(step[1]) % workers}"
        rmw = re.search(r"rmw_\w+_cpp", nodeid)
        return f"{file}::{rmw[0]}" if rmw else file


@pytest.hookimpl(tryfirst=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> LoadScopeScheduling:
    """Share the tests out by files."""
    return _ByFile(config, log)
