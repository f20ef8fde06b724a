"""``ros2 topic list``, ``info``, ``echo`` and ``hz`` for a cell: they print what these commands print."""

from __future__ import annotations

from tutorial.notebook.desk import keep_once
from tutorial.printing import say, say_all
from tutorial.ros import topics
from tutorial.ros.node_thread import MeteredNode, NodeThread
from tutorial.ros.topics.listing import topics_with_types
from tutorial.ros.topics.names import full_name

__all__ = ["has_met_the_others", "topic_echo", "topic_hz", "topic_info", "topic_list"]

PATIENCE = 10.0  # [s] that `topic_echo` and `topic_hz` wait for a message
REPORTS = 2  # of `topic_hz`


async def topic_list(show_types: bool = False) -> None:
    """Print the topics that there are, as ``ros2 topic list`` does.

    Args:
        show_types: with their types, as with ``-t``.
    """
    say(topics.topic_list(await _asker(), show_types))


async def topic_info(topic: str, verbose: bool = False) -> None:
    """Print who publishes and who subscribes, as ``ros2 topic info`` does.

    Args:
        topic: its full name.
        verbose: with their nodes and their quality of service, as with ``-v``.

    Raises:
        TutorialError: there is no such topic.
    """
    say(topics.topic_info(await _asker(topic), topic, verbose))


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
    count = 1 if once else None
    echo = topics.topic_echo(await _asker(topic), topic, count=count, field=field, no_arr=no_arr, timeout=PATIENCE)
    await say_all(echo)


async def topic_hz(topic: str, window: int = 10_000) -> None:
    """Print at what rate messages come, twice, a second apart, as ``ros2 topic hz`` does.

    Args:
        topic: its full name.
        window: how many messages the average is taken over.

    Raises:
        TutorialError: nobody publishes on it for 10 s.
    """
    await say_all(topics.topic_hz(await _asker(topic), topic, window=window, timeout=PATIENCE), REPORTS)


async def _asker(topic: str | None = None) -> MeteredNode:
    """The node that asks, when it has met all others, and a topic if it is there; the kernel stays free meanwhile.

    It waits for the other nodes of this kernel, which Fast DDS takes seconds to meet: they are there for certain. Its
    name begins with an underscore, so ``ros2 node list`` doesn't show it.
    """
    node = keep_once("topic tools", lambda: NodeThread("_notebook"), NodeThread.close).node

    def has_met_them() -> bool:
        is_there = topic is None or topic in topics_with_types(node, include_hidden=True)
        return is_there and has_met_the_others(node)

    await topics.wait_for_graph(node, has_met_them)
    return node


def has_met_the_others(node: MeteredNode) -> bool:
    """Whether a node knows of all other nodes of this kernel."""
    met = {full_name(*each) for each in node.get_node_names_and_namespaces()}
    return met.issuperset(each.full_name for each in NodeThread.alive)
