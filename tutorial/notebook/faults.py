"""Step 9's deliberately broken programs: each should publish joint states to a viewer, but the viewer shows none."""

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
    """Stop the previous program, start a broken one in a separate process, and wait until its node is discovered.

    A node in a different domain is never discovered, so the wait has a short timeout.

    Args:
        number: the program's number, from 1. Its source is ``faults/tankN.py`` in the notebooks' folder.
        source: source code to run instead, such as a repaired version.

    Raises:
        TutorialError: there is no program with this number, or the program failed to start.
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
    """Return whether `node` has discovered a publisher of joint states in the node called `name`."""
    topics = (topic for topic in topics_with_types(node) if topic.endswith("/joint_state"))
    return any(info.node_name == name for topic in topics for info in publishers_on(node, topic))
