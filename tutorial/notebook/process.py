"""What importing `tutorial.notebook` does to the process, which is the kernel's: all of it is here."""

from __future__ import annotations

import atexit
import logging
import os
from contextlib import ExitStack
from types import CoroutineType
from typing import Any

from ipykernel.comm.comm import BaseComm
from IPython.core.getipython import get_ipython

from tutorial.notebook.desk import close_all, logged
from tutorial.ros.domains import reserved_domain

_until_exit = ExitStack()


def prepare_process() -> None:
    """Make the process a notebook's. Importing `tutorial.notebook` calls it, once; it holds until the process ends.

    - Unless ``ROS_DOMAIN_ID`` names one, the process has a ROS domain of its own, for two notebooks must not meet. What
      it starts inherits it.
    - Unless ``ROS_AUTOMATIC_DISCOVERY_RANGE`` says otherwise, it is heard on this machine only: with a real ROS 2, too,
      whose default is the whole network. In a room full of learners two would sooner or later have one domain.
    - What the library logs is kept for `tutorial.notebook.log`, and goes nowhere else.
    - At the end everything that is open is closed.
    - In IPython, a coroutine that a cell would display says that it lacks its ``await``.
    - In a kernel, what a page says comes on the thread that the page asks for; on the main one, after the cell.
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
    if lock := getattr(getattr(shell, "kernel", None), "_main_asyncio_lock", None):
        _take_messages_in_turn(lock)


def _explain(coroutine: CoroutineType[Any, Any, Any], printer: Any, _cycle: bool) -> None:
    printer.text(f"{coroutine.__qualname__} has not run yet: this takes a while, so write await before it.")
    coroutine.close()  # it cannot be awaited by its name any more; this keeps Python from complaining of it later


def _take_messages_in_turn(lock: Any) -> None:
    """Have messages of pages taken as ipykernel 7.3 does.

    ipykernel 7.4 brings them to the thread that spoke to the page last, which is the main one, and takes them there
    while a cell runs. If that cell ends meanwhile, the next one's output and end are told in its name: the page waits
    for ever for the end.

    Args:
        lock: what the kernel holds while a cell runs; it takes a message at once if this says that it is locked.
    """
    BaseComm._reply_subshell_for = None  # type: ignore[assignment, method-assign]
    lock.locked = lambda: False
