"""``ros2 topic list``, ``info``, ``echo`` and ``hz`` for a cell: they print what these commands print."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from contextlib import aclosing

from tutorial.commands.asking import meet
from tutorial.notebook.desk import keep_once
from tutorial.ros import topics
from tutorial.ros.node_thread import MeteredNode, NodeThread

__all__ = ["topic_echo", "topic_hz", "topic_info", "topic_list"]

PATIENCE = 10.0  # [s] that `topic_echo` waits for a message


async def topic_list(show_types: bool = False) -> None:
    """Print the topics that there are, as ``ros2 topic list`` does.

    Args:
        show_types: with their types, as with ``-t``.
    """
    print(topics.topic_list(await _settled(), show_types), end="")  # noqa: T201 - what it is for


async def topic_info(topic: str, verbose: bool = False) -> None:
    """Print who publishes and who subscribes, as ``ros2 topic info`` does.

    Args:
        topic: its full name.
        verbose: with their nodes and their quality of service, as with ``-v``.

    Raises:
        TutorialError: there is no such topic.
    """
    print(topics.topic_info(await _settled(), topic, verbose), end="")  # noqa: T201


async def topic_echo(topic: str, once: bool = False, field: str | None = None) -> None:
    """Print messages as they come, as ``ros2 topic echo`` does; to interrupt the kernel ends it.

    Args:
        topic: its full name.
        once: print one message, as with ``--once``.
        field: print only this field, as with ``--field``, for instance ``"position"``.

    Raises:
        TutorialError: there is no such topic or field, or nobody publishes on it for 10 s.
    """
    await _print(topics.topic_echo(await _settled(), topic, count=1 if once else None, field=field, timeout=PATIENCE))


async def topic_hz(topic: str, window: int = 10_000, reports: int = 2) -> None:
    """Print at what rate messages come, about once a second, as ``ros2 topic hz`` does.

    Args:
        topic: its full name.
        window: how many messages the average is taken over.
        reports: how often to print before it ends.
    """
    await _print(topics.topic_hz(await _settled(), topic, window=window), reports)


async def _settled() -> MeteredNode:
    """The node that asks, when it has met all others; the kernel stays free meanwhile.

    Its name begins with an underscore, so ``ros2 node list`` doesn't show it.
    """
    node = keep_once("topic tools", lambda: NodeThread("_notebook"), NodeThread.close).node
    await meet(node)
    return node


async def _print(texts: AsyncGenerator[str, None], count: int | None = None) -> None:
    """Print texts as they come: so many of them, or to the end."""
    async with aclosing(texts):
        async for text in texts:
            print(text, end="", flush=True)  # noqa: T201
            count = None if count is None else count - 1
            if count == 0:
                return
