"""``ros2 topic list``, ``info``, ``echo`` and ``hz`` for a cell: they print what these commands print."""

from tutorial.notebook.desk import keep_once
from tutorial.ros.node_thread import MeteredNode, NodeThread
from tutorial.ros.topics import listening, listing
from tutorial.system.printing import say, say_all

PATIENCE = 10.0  # [s] that `topic_echo` and `topic_hz` wait for a message
REPORTS = 2  # of `topic_hz`


async def topic_list(show_types: bool = False) -> None:
    """Print the topics that there are, as ``ros2 topic list`` does.

    Args:
        show_types: with their types, as with ``-t``.
    """
    say(await listing.topic_list(_asker(), show_types))


async def topic_info(topic: str, verbose: bool = False) -> None:
    """Print who publishes and who subscribes, as ``ros2 topic info`` does.

    Args:
        topic: its full name.
        verbose: with their nodes and their quality of service, as with ``-v``.

    Raises:
        TutorialError: there is no such topic.
    """
    say(await listing.topic_info(_asker(), topic, verbose))


async def topic_echo(topic: str, once: bool = False, field: str | None = None, no_arr: bool = False) -> None:
    """Print messages as they come, as ``ros2 topic echo`` does; to interrupt the kernel ends it.

    Args:
        topic: its full name.
        once: print one message, as with ``--once``.
        field: print only this field, as with ``--field``, for instance ``"position"``.
        no_arr: print of each array only what it is, as with ``--no-arr``.

    Raises:
        TutorialError: there is no such topic or field, or nobody publishes on it for 10 s.
    """
    await say_all(listening.topic_echo(_asker(), topic, once=once, field=field, no_arr=no_arr, timeout=PATIENCE))


async def topic_hz(topic: str, window: int = 10_000) -> None:
    """Print at what rate messages come, twice, a second apart, as ``ros2 topic hz`` does.

    Args:
        topic: its full name.
        window: how many messages the average is taken over.

    Raises:
        TutorialError: nobody publishes on it for 10 s.
    """
    await say_all(listening.topic_hz(_asker(), topic, window=window, timeout=PATIENCE), REPORTS)


def _asker() -> MeteredNode:
    """The node that asks. Its name begins with an underscore, so ``ros2 node list`` doesn't show it."""
    return keep_once("topic tools", lambda: NodeThread("_notebook"), NodeThread.close).node
