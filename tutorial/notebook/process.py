"""All side effects that importing `tutorial.notebook` has on the kernel's process."""

from __future__ import annotations

import atexit
import logging
import os
from contextlib import ExitStack
from types import CoroutineType
from typing import Any

from ipykernel._version import version_info
from ipykernel.comm.comm import BaseComm
from IPython.core.getipython import get_ipython

from tutorial.notebook.desk import close_all, logged
from tutorial.ros.domains import reserved_domain

FIRST_CONCURRENT = (7, 4)  # the first version of ipykernel that handles comm messages while a cell runs

_until_exit = ExitStack()


def prepare_process() -> None:
    """Set up the process for a notebook. Importing `tutorial.notebook` calls this once.

    - Reserve a ROS domain for this process and its children, unless ``ROS_DOMAIN_ID`` is set: two notebooks must not
      share a domain.
    - Restrict discovery to this machine, unless ``ROS_AUTOMATIC_DISCOVERY_RANGE`` is set. By default, a real ROS 2
      discovers nodes on the whole network; in a classroom, two learners would sooner or later share a domain.
    - Keep the library's log lines for `tutorial.notebook.log`, and send them nowhere else.
    - When the process ends, close everything that is open.
    - Have IPython point out a missing ``await`` where a cell would display a coroutine.
    - Have the kernel handle a page's messages on the thread that the page requests, and on the main thread only between
      cells.
    """
    if not os.environ.get("ROS_DOMAIN_ID"):
        os.environ["ROS_DOMAIN_ID"] = str(_until_exit.enter_context(reserved_domain()))
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    logger = logging.getLogger("tutorial")
    logger.addHandler(logged)
    logger.propagate = False
    atexit.register(close_all)
    shell = get_ipython()
    if shell is not None and shell.display_formatter is not None:
        shell.display_formatter.formatters["text/plain"].for_type(CoroutineType, _explain)
    lock = getattr(getattr(shell, "kernel", None), "_main_asyncio_lock", None)
    if lock is not None and version_info[:2] >= FIRST_CONCURRENT:
        _handle_comms_between_cells(lock)


def _explain(coroutine: CoroutineType[Any, Any, Any], printer: Any, _cycle: bool) -> None:
    printer.text(f"{coroutine.__qualname__} has not run yet: this call takes a while, so write await before it.")
    coroutine.close()  # nothing can await the coroutine now; without this call, Python would warn about that later


def _handle_comms_between_cells(lock: Any) -> None:
    """Handle comm messages as ipykernel 7.3 does: on the main thread, and only once the running cell has finished.

    ipykernel 7.4 handles them while an async cell runs, so that the cell can await a widget's reply
    (https://github.com/ipython/ipykernel/issues/646). If the cell ends in the meantime, the next cell's output and its
    "idle" status name the ended cell as their parent, and the page waits for them forever. ipykernel 7.4 also routes a
    page's messages to the thread that wrote to the page last, usually the main thread, even if the page requests a
    different thread. ipykernel has no setting for either behaviour, so this function replaces private attributes. A
    test checks that ipykernel still has these attributes.

    Args:
        lock: the kernel's lock, held while a cell runs. While the lock reports that it is locked, the kernel handles
            comm messages at once.
    """
    BaseComm._reply_subshell_for = None  # type: ignore[assignment, method-assign]
    lock.locked = lambda: False
