"""A pytest plugin: run each notebook in a separate ROS domain, by a kernel that ignores the user's settings."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial

import nbval.kernel
import pytest
from jupyter_client.manager import KernelManager
from nbval.plugin import IPyNbFile
from pictures import need_pictures
from real_ros import need_ros_for

from tutorial.ros.domains import reserved_domain

_open: dict[IPyNbFile, ExitStack] = {}


def pytest_configure(config: pytest.Config) -> None:
    """Keep no record of solved exercises."""
    folder = tempfile.TemporaryDirectory(prefix="progress-")
    config.add_cleanup(folder.cleanup)
    os.environ["TANK_PROGRESS"] = os.path.join(folder.name, "progress.json")  # noqa: PTH118


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip the cells of a notebook that needs what this machine or this run lacks: images, or a real ROS 2."""
    if isinstance(item.parent, IPyNbFile):
        need_ros_for(item.parent.path)
        if item.parent.path.stem == "6_camera_publisher":
            need_pictures()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> Iterator[None]:
    """Wrap each cell; the first one of a notebook starts its kernel, the last one ends it."""
    notebook = item.parent
    if isinstance(notebook, IPyNbFile) and notebook not in _open:
        _open[notebook] = own_surroundings()
    result = yield
    if notebook in _open and (nextitem is None or nextitem.parent is not notebook):
        _open.pop(notebook).close()
    return result


def own_surroundings() -> ExitStack:
    """Give kernels that start until this is closed a separate domain and settings."""
    stack = ExitStack()
    environment = stack.enter_context(pytest.MonkeyPatch.context())
    environment.setenv("ROS_DOMAIN_ID", str(stack.enter_context(reserved_domain())))
    settings = stack.enter_context(tempfile.TemporaryDirectory(prefix="ipython-"))
    environment.setenv("IPYTHONDIR", settings)
    environment.setenv("TANK_PROGRESS", f"{settings}/progress.json")
    no_ports = partial(KernelManager, transport="ipc", ip=f"{settings}/socket")  # no port for others to take
    environment.setattr(nbval.kernel, "KernelManager", no_ports)
    return stack
