"""``tank doctor TOPIC``: print why no messages on a topic arrive here."""

import os
import signal
from collections.abc import Sequence
from contextlib import ExitStack

from tutorial.commands.asking import named_node
from tutorial.commands.terminal import until_asked
from tutorial.ros.doctor.examine import DOMAINS, examine
from tutorial.ros.doctor.facts import Facts
from tutorial.ros.doctor.report import report
from tutorial.ros.doctor.rules import diagnose
from tutorial.system.printing import print_text


def doctor_of(topic: str, ros_args: Sequence[str], domains: Sequence[int] = ()) -> int:
    """Print why no messages on a topic arrive here, or that all is well.

    Args:
        topic: the topic's name.
        ros_args: ROS 2's arguments.
        domains: the other domains to search for the topic; by default, 0 to 10.

    Returns:
        The exit status: 1 if a cause was found, 0 if all is well, or 2 after Ctrl-C.

    Raises:
        TutorialError: the topic's name is invalid, or a node could not be created for a reason that no rule covers.
    """
    found: list[Facts] = []

    async def look() -> None:
        with ExitStack() as stack:
            make_node = lambda: stack.enter_context(named_node(f"_tank_{os.getpid()}", ros_args)).node  # noqa: E731
            found.append(await examine(topic, make_node, domains=domains or DOMAINS))

    if until_asked(look()):
        return signal.SIGINT
    print_text(report(found[0]))
    return int(bool(diagnose(found[0])))
