"""A pytest plugin: each notebook is run in a ROS domain of its own, by a kernel that no user's settings change."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack

sys.modules["rfc3987_syntax"] = None  # takes a second to import, and checks a kind of address that no notebook has

# ruff: noqa: E402
import pytest
from domains import reserved_domain
from nbval.plugin import IPyNbFile

_open: dict[IPyNbFile, ExitStack] = {}


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> Iterator[None]:
    """Around each cell; the first one of a notebook starts its kernel, the last one ends it."""
    notebook = item.parent
    if isinstance(notebook, IPyNbFile) and notebook not in _open:
        _open[notebook] = _own_surroundings()
    result = yield
    if notebook in _open and (nextitem is None or nextitem.parent is not notebook):
        _open.pop(notebook).close()
    return result


def _own_surroundings() -> ExitStack:
    stack = ExitStack()
    environment = stack.enter_context(pytest.MonkeyPatch.context())
    environment.setenv("ROS_DOMAIN_ID", str(stack.enter_context(reserved_domain())))
    environment.setenv("IPYTHONDIR", stack.enter_context(tempfile.TemporaryDirectory(prefix="ipython-")))
    return stack
