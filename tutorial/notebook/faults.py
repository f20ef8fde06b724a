"""The programs of step 9, broken on purpose: each should publish joint states to a viewer, which shows none of them."""

import shlex
import sys

from rclpy.node import Node

from tutorial.errors import TutorialError
from tutorial.notebook.command import Command
from tutorial.notebook.desk import close_kept, keep
from tutorial.notebook.topic_tools import asker
from tutorial.ros.topics.endpoints import publishers_on
from tutorial.ros.topics.graph import wait_for_graph
from tutorial.ros.topics.listing import topics_with_types
from tutorial.system.paths import HOME

NAME = "fault"  # the running program's name in the registry; only one program runs at a time


async def start_fault(number: int, source: str | None = None) -> Command:
    """Start a broken program in a separate process, after stopping the previous one; wait until it is visible.

    A program in a different domain never becomes visible, so the wait is short.

    Args:
        number: the program's number, from 1. Its source is ``faults/tankN.py`` in the notebooks' folder.
        source: source code to run instead, such as a repaired version.

    Raises:
        TutorialError: there is no program with this number, or it failed.
    """
    paths = sorted((HOME / "notebooks" / "faults").glob("tank*.py"))
    if number not in range(1, len(paths) + 1):
        raise TutorialError(f"there is no fault {number}. The faults are numbered 1 to {len(paths)}.")
    program = [str(paths[number - 1])] if source is None else ["-c", source]
    command = keep(NAME, lambda: Command(shlex.join([sys.executable, *program])), Command.close)
    await command.says("started")
    await wait_for_graph(asker(), lambda: _publishes(asker(), f"tank{number}"))
    return command


def stop_fault() -> None:
    """Stop the program that `start_fault` started. Idempotent."""
    close_kept(NAME)


def _publishes(node: Node, name: str) -> bool:
    """Return whether a node has discovered that the node with this name publishes joint states."""
    topics = (topic for topic in topics_with_types(node) if topic.endswith("/joint_state"))
    return any(info.node_name == name for topic in topics for info in publishers_on(node, topic))
