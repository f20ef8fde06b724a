"""A pytest plugin that distributes tests to workers.

It is a plugin because pytest does not read conftest.py when only notebooks run, whose cells have to stay together.
"""

import os
import re

import pytest
from xdist.scheduler import LoadScopeScheduling

SHARED_OUT = {"test_notebooks_in_browser.py": 2, "test_cells_twice.py": 9}
"""Files with one test per notebook, and the maximum number of workers that share them. Each worker has its own
JupyterLab and browser, and two cores cannot handle more."""

LONG = {
    "test_cells_twice.py",
    "test_drive.py",
    "test_two_machines.py",
    "test_check.py",
    "test_processes.py",
    "test_behaviour.py",
    "test_tables.py",
}
"""Files that take a long time. If one of them came last, the other workers would wait for it."""

MORE_THAN_CORES = 1  # workers, because tests often wait: for discovery, a duration, or the end of a process


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run the notebooks and browser tests first, then the long files, so that all workers finish at the same time."""
    items.sort(key=_turn)


def _turn(item: pytest.Item) -> tuple[int, int]:
    """Return a test's place in the order. Larger notebooks come first, because they take longer."""
    if item.path.suffix == ".ipynb":
        return 0, -item.path.stat().st_size
    if item.get_closest_marker("browser"):
        return 0, 0
    return (1 if item.path.name in LONG else 2), 0


@pytest.hookimpl(tryfirst=True)
def pytest_xdist_auto_num_workers() -> int:
    """Return the number of tests that run at the same time."""
    return (os.cpu_count() or 1) + MORE_THAN_CORES


class _ByFile(LoadScopeScheduling):
    """Keeps the tests of a file (and RMW) together, and the cells of a notebook in order."""

    def _split_scope(self, nodeid: str) -> str:
        file, *_ = nodeid.split("::")
        workers, step = SHARED_OUT.get(os.path.basename(file)), re.search(r"\[(\d+)_", nodeid)  # noqa: PTH119
        if workers and step:
            return f"{file}::{int(step[1]) % workers}"
        rmw = re.search(r"rmw_\w+_cpp", nodeid)
        return f"{file}::{rmw[0]}" if rmw else file


@pytest.hookimpl(tryfirst=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> LoadScopeScheduling:
    """Distribute the tests by file."""
    return _ByFile(config, log)
