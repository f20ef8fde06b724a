"""``ros2 node list``, ``ros2 topic list/info/echo/hz`` and ``tank doctor TOPIC`` as functions for cells."""

from collections.abc import Iterable

from tutorial.notebook.desk import keep_once
from tutorial.ros.doctor.examine import examine
from tutorial.ros.doctor.report import report
from tutorial.ros.node_thread import MeteredNode, NodeThread
from tutorial.ros.topics import listening, listing
from tutorial.system.printing import print_text, print_texts

TIMEOUT = 10.0  # [s] how long `topic_echo` and `topic_hz` wait for a message
REPORTS = 2  # the number of reports that `topic_hz` prints


async def node_list() -> None:
    """Print the full names of the nodes, as ``ros2 node list`` does."""
    print_text(await listing.node_list(asker()))


async def topic_list(show_types: bool = False) -> None:
    """Print the topics, as ``ros2 topic list`` does.

    Args:
        show_types: whether to also print the topics' types, as with ``-t``.
    """
    print_text(await listing.topic_list(asker(), show_types))


async def topic_info(topic: str, verbose: bool = False) -> None:
    """Print a topic's type and how many publishers and subscriptions it has, as ``ros2 topic info`` does.

    Args:
        topic: the full name of the topic.
        verbose: whether to also print each endpoint's node and quality of service, as with ``-v``.

    Raises:
        TutorialError: there is no such topic.
    """
    print_text(await listing.topic_info(asker(), topic, verbose))


async def topic_echo(topic: str, once: bool = False, field: str | None = None, no_arr: bool = False) -> None:
    """Print messages as they arrive, as ``ros2 topic echo`` does. Interrupt the kernel to stop.

    Args:
        topic: the full name of the topic.
        once: print only one message, as with ``--once``.
        field: print only this field, as with ``--field``, for instance ``"position"``.
        no_arr: print only the type and length of each array, as with ``--no-arr``.

    Raises:
        TutorialError: there is no such topic or field, or no message arrives for 10 s.
    """
    await print_texts(listening.topic_echo(asker(), topic, once=once, field=field, no_arr=no_arr, timeout=TIMEOUT))


async def topic_hz(topic: str, window: int = 10_000, timeout: float = TIMEOUT) -> None:
    """Print two reports of a topic's message rate, a second apart, in the format of ``ros2 topic hz``.

    Args:
        topic: the full name of the topic.
        window: the number of messages to average over.
        timeout: the maximum time to wait for a message [s].

    Raises:
        TutorialError: no message arrives in time.
    """
    await print_texts(listening.topic_hz(asker(), topic, window=window, timeout=timeout), REPORTS)


async def why(topic: str, joints: Iterable[str] | None = None) -> None:
    """Print why this kernel receives no messages on a topic, as ``tank doctor TOPIC`` does. This takes four seconds.

    Args:
        topic: the name of the topic.
        joints: for joint states, the names of the joints that the viewer has; by default, the tank's joints for the
            tank's topic, and the joints of the first message for any other topic.

    Raises:
        TutorialError: the topic's name is invalid.
    """
    print_text(report(await examine(topic, asker, joints)))


def asker() -> MeteredNode:
    """Return the node that these tools share. Its name begins with an underscore, so ``ros2 node list`` hides it."""
    return keep_once("topic tools", lambda: NodeThread("_notebook"), NodeThread.close).node
