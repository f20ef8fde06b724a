"""What ``ros2 topic`` prints - list, info, echo, hz - as text, for whichever rclpy is in use.

The node that asks has a thread of its own, `tutorial.ros.NodeThread`. Nothing here prints.
"""

from __future__ import annotations

import asyncio
import math
from collections import deque
from collections.abc import AsyncGenerator

from rclpy.duration import Duration, Infinite
from rclpy.node import Node
from rclpy.qos import HistoryPolicy
from rclpy.topic_endpoint_info import TopicEndpointInfo

from tutorial.errors import TutorialError
from tutorial.topics.inbox import Inbox, message_class
from tutorial.topics.message_yaml import field_text
from tutorial.topics.names import is_hidden

__all__ = ["topic_echo", "topic_hz", "topic_info", "topic_list"]

LOOK_EVERY = 0.1  # [s] for a topic that is not there yet
HZ_EVERY = 1.0  # [s] between two texts of topic_hz
DEFAULT_WINDOW = 10_000  # intervals, of ros2 topic hz


def topic_list(node: Node, show_types: bool = False) -> str:
    """List the topics there are, but for hidden ones, as ``ros2 topic list``.

    Args:
        node: that asks.
        show_types: add each topic's type, as with ``-t``.

    Returns:
        One line for each topic.
    """
    topics = [(topic, types) for topic, types in sorted(node.get_topic_names_and_types()) if not is_hidden(topic)]
    return "".join(f"{topic} [{', '.join(types)}]\n" if show_types else f"{topic}\n" for topic, types in topics)


def topic_info(node: Node, topic: str, verbose: bool = False) -> str:
    """Say who publishes and subscribes, as ``ros2 topic info``.

    Args:
        node: that asks.
        topic: its full name.
        verbose: describe each publisher and subscription with its quality of service, as with ``-v``.

    Raises:
        TutorialError: there is no such topic; the text is that of ``ros2``.
    """
    types = dict(node.get_topic_names_and_types()).get(topic)
    if types is None:
        raise TutorialError(f"Unknown topic '{topic}'")
    publishers = node.get_publishers_info_by_topic(topic)
    subscriptions = node.get_subscriptions_info_by_topic(topic)
    parts = [f"Type: {types[0] if len(types) == 1 else types}", f"Publisher count: {len(publishers)}"]
    parts += [_endpoint_text(info) for info in publishers if verbose]
    parts += [f"Subscription count: {len(subscriptions)}"]
    parts += [_endpoint_text(info) for info in subscriptions if verbose]
    end = "\n\n" if verbose else "\n"
    return end.join(parts) + end


async def topic_echo(
    node: Node, topic: str, *, count: int | None = None, field: str | None = None, timeout: float | None = None
) -> AsyncGenerator[str, None]:
    """Show messages as they come, as ``ros2 topic echo``.

    The subscription lives as long as the iteration: give that up with `contextlib.aclosing`, or by cancelling.

    Args:
        node: that subscribes; its thread must spin.
        topic: its full name.
        count: how many messages; 1 is ``--once``, None goes on for ever.
        field: show only this field: ``"position"``, ``"header.stamp"``.
        timeout: how long to wait for each message at most [s]; None for ever.

    Yields:
        The text of each message, with the closing ``---``.

    Raises:
        TutorialError: the topic or the field is unknown, with the text of ``ros2``; or no message came in time.
    """
    type_name = _type_of(node, topic)
    if type_name is None:
        raise TutorialError(f"{_warning(topic)}\nCould not determine the type for the passed topic")
    inbox = Inbox(node, message_class(type_name), topic)
    try:
        while count is None or count > 0:
            _, message = await inbox.next(timeout)
            yield f"{field_text(message, field)}---\n"
            count = None if count is None else count - 1
    finally:
        inbox.close()


async def topic_hz(node: Node, topic: str, *, window: int = DEFAULT_WINDOW) -> AsyncGenerator[str, None]:
    """Measure the rate at which messages come in, as ``ros2 topic hz``; it goes on for ever.

    While nothing new comes, it says nothing.

    Args:
        node: that subscribes; its thread must spin.
        topic: its full name. If there is none, a warning is the first text, and the wait for it begins.
        window: how many intervals between messages count, the newest.

    Yields:
        About once a second: average rate [Hz], and of the intervals the extremes and the standard deviation [s].
    """
    if _type_of(node, topic) is None:
        yield f"{_warning(topic)}\n"
    while (type_name := _type_of(node, topic)) is None:
        await asyncio.sleep(LOOK_EVERY)
    inbox = Inbox(node, message_class(type_name), topic, kept=window + 1, times_only=True)
    intervals: deque[float] = deque(maxlen=window)
    try:
        before, _ = await inbox.next()
        told = before
        while True:
            now, _ = await inbox.next()
            intervals.append(now - before)
            before = now
            if now >= told + HZ_EVERY:
                told = now
                yield _rate_text(intervals)
    finally:
        inbox.close()


def _type_of(node: Node, topic: str) -> str | None:
    """The type of a topic; None if there is no such topic.

    Raises:
        TutorialError: it has several.
    """
    types = dict(node.get_topic_names_and_types()).get(topic, [])
    if len(types) > 1:
        raise TutorialError(f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]")
    return types[0] if types else None


def _warning(topic: str) -> str:
    return f"WARNING: topic [{topic}] does not appear to be published yet"


def _endpoint_text(info: TopicEndpointInfo) -> str:
    """Describe a publisher or subscription in the lines of ``ros2 topic info -v``."""
    qos = info.qos_profile
    history = qos.history.name
    if qos.history == HistoryPolicy.KEEP_LAST:
        history += f" ({qos.depth})"
    return "\n".join(
        (
            f"Node name: {info.node_name}",
            f"Node namespace: {info.node_namespace}",
            f"Topic type: {info.topic_type}",
            f"Topic type hash: {info.topic_type_hash}",
            f"Endpoint type: {info.endpoint_type.name}",
            f"GID: {'.'.join(f'{byte:02x}' for byte in info.endpoint_gid)}",
            "QoS profile:",
            f"  Reliability: {qos.reliability.name}",
            f"  History (Depth): {history}",
            f"  Durability: {qos.durability.name}",
            f"  Lifespan: {_duration_text(qos.lifespan)}",
            f"  Deadline: {_duration_text(qos.deadline)}",
            f"  Liveliness: {qos.liveliness.name}",
            f"  Liveliness lease duration: {_duration_text(qos.liveliness_lease_duration)}",
        )
    )


def _duration_text(duration: Duration) -> str:
    return "Infinite" if duration == Infinite else f"{duration.nanoseconds} nanoseconds"


def _rate_text(intervals: deque[float]) -> str:
    """The two lines of ``ros2 topic hz``."""
    mean = sum(intervals) / len(intervals)
    deviation = math.sqrt(sum((interval - mean) ** 2 for interval in intervals) / len(intervals))
    return (
        f"average rate: {1 / mean if mean > 0 else 0.0:.3f}\n"
        f"\tmin: {min(intervals):.3f}s max: {max(intervals):.3f}s std dev: {deviation:.5f}s window: {len(intervals)}\n"
    )
