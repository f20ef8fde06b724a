"""Subscribe to a topic, and yield the output of ``ros2 topic echo`` and ``ros2 topic hz`` as text.

The node must be spinning on its own thread (`tutorial.ros.node_thread.NodeThread`). These functions print nothing.
"""

import asyncio
import math
import time
from collections import deque
from collections.abc import AsyncGenerator
from contextlib import aclosing, asynccontextmanager
from typing import Any

import numpy as np
from rclpy.node import Node

from tutorial.errors import TutorialError
from tutorial.handoff import CallQueue
from tutorial.ros.topics.endpoints import reader_qos
from tutorial.ros.topics.graph import wait_for_graph
from tutorial.ros.topics.message_yaml import field_text
from tutorial.ros.topics.names import escape_name, full_topic, message_class

LOOK_EVERY = 0.1  # [s] between checks for a topic that does not exist yet
HZ_EVERY = 1.0  # [s] between reports from topic_hz
DEFAULT_WINDOW = 10_000  # intervals, as in ros2 topic hz

NO_TYPE = "Could not determine the type for the passed topic"


async def topic_echo(
    node: Node,
    topic: str,
    message_type: str | None = None,
    *,
    once: bool = False,
    field: str | None = None,
    no_arr: bool = False,
    timeout: float | None = None,
) -> AsyncGenerator[str, None]:
    """Yield the messages from a topic as text, like ``ros2 topic echo``.

    The subscription exists until the iteration ends: end the iteration with `contextlib.aclosing`, or cancel the task.

    Args:
        node: the node that subscribes; must be spinning on another thread.
        topic: the topic's name; if there is no such topic, wait briefly for it.
        message_type: the type to subscribe with, such as ``"sensor_msgs/msg/Joy"``; required if the topic does not
            appear in time or has several types. None to use the topic's only type.
        once: stop after the first message instead of continuing forever.
        field: show only this field, such as ``"position"`` or ``"header.stamp"``.
        no_arr: show only the type and length of each array.
        timeout: maximum wait for each message [s]; None to wait forever.

    Yields:
        The text of each message, including the closing ``---``.

    Raises:
        TutorialError: the topic, the type or the field is unknown (the error text is the same as in ``ros2``), or no
            message arrived in time.
    """
    if message_type is None:
        topic = await _known(node, topic)
        message_type = _type_of(node, topic)
    if message_type is None:
        raise TutorialError(f"{_not_published(topic)}\n{NO_TYPE}")
    async with aclosing(_messages(node, message_class(message_type), full_topic(node, topic), timeout)) as messages:
        async for _, message in messages:
            yield field_text(message, field, no_arr)
            if once:
                return


async def topic_hz(
    node: Node, topic: str, *, window: int = DEFAULT_WINDOW, timeout: float | None = None
) -> AsyncGenerator[str, None]:
    """Measure the rate of a topic's messages forever, like ``ros2 topic hz``.

    Yield nothing while no messages arrive, and start over when simulated time jumps backwards.

    Args:
        node: the node that subscribes; must be spinning on another thread. If the node uses simulated time, intervals
            are measured in simulated time.
        topic: the topic's name; if there is no such topic, wait briefly for it, then yield a warning and keep waiting.
        window: the number of recent intervals to average over.
        timeout: maximum wait for the topic, and then for each message [s]; None to wait forever.

    Yields:
        About once a second, the average rate [Hz] and the minimum, maximum and standard deviation of the intervals [s].

    Raises:
        TutorialError: no message arrived in time.
    """
    topic = await _known(node, topic)
    if _type_of(node, topic) is None:
        yield f"{_not_published(topic)}\n"
    async with _in_time(node, topic, timeout):
        while (type_name := _type_of(node, topic)) is None:
            await asyncio.sleep(LOOK_EVERY)
    intervals: deque[float] = deque(maxlen=window)
    kind = message_class(type_name)
    async with aclosing(_messages(node, kind, topic, timeout, times_only=True)) as messages:
        before = told = math.inf
        async for now, _ in messages:
            if now < before:
                intervals.clear()
                before = told = now if now > 0 else math.inf  # simulated time is 0 before the first message on /clock
                continue
            intervals.append(now - before)
            before = now
            if now >= told + HZ_EVERY:
                told = now
                yield _rate_text(intervals)


async def _messages(
    node: Node, kind: Any, topic: str, timeout: float | None, times_only: bool = False
) -> AsyncGenerator[tuple[float, Any], None]:
    """Yield the messages from a topic, each with its arrival time [s], in simulated time or from `time.monotonic`.

    Args:
        node: the node that subscribes; must be spinning on another thread.
        kind: the class of the messages.
        topic: the topic's full name.
        timeout: maximum wait for each message [s]; None to wait forever.
        times_only: yield None instead of each message, without decoding it, and queue up to 10,000 messages.

    Raises:
        TutorialError: no message arrived in time.
    """
    received: deque[tuple[float, Any]] = deque(maxlen=DEFAULT_WINDOW if times_only else 100)
    news = asyncio.Event()
    calls = CallQueue(asyncio.get_running_loop())
    scope = calls.scope(f"a look at {topic}")

    def on_message(message: Any) -> None:  # executor's thread: store the message and its time, and wake the loop
        clock = node.get_clock()
        now = clock.now().nanoseconds / 1e9 if clock.ros_time_is_active else time.monotonic()
        received.append((now, None if times_only else message))
        scope.call_latest("news", news.set)

    subscription = node.create_subscription(kind, topic, on_message, reader_qos(node, topic), raw=times_only)
    try:
        while True:
            async with _in_time(node, topic, timeout):
                while not received:
                    news.clear()
                    await news.wait()
            yield received.popleft()
    finally:
        calls.close()
        node.destroy_subscription(subscription)


@asynccontextmanager
async def _in_time(node: Node, topic: str, timeout: float | None) -> AsyncGenerator[None, None]:
    """Limit how long to wait for a message [s]; None means no limit.

    Raises:
        TutorialError: no message arrived in time.
    """
    try:
        async with asyncio.timeout(timeout):
            yield
    except TimeoutError:
        count = node.count_publishers(topic)
        raise TutorialError(
            f"no message arrived on {topic} within {timeout:g} s; it has {count} "
            f"publisher{'s' if count != 1 else ''}. Start the program that publishes the topic, or wait longer."
        ) from None


async def _known(node: Node, topic: str) -> str:
    """Wait briefly for a topic to appear, and return its full name."""
    name = full_topic(node, topic)
    await wait_for_graph(node, lambda: _type_of(node, name))
    return name


def _type_of(node: Node, topic: str) -> str | None:
    """Return the type of a topic; None if there is no such topic.

    Raises:
        TutorialError: the topic has several types.
    """
    types = dict(node.get_topic_names_and_types()).get(topic, [])
    if len(types) > 1:
        names = ", ".join(map(escape_name, types))
        raise TutorialError(f"Cannot echo topic '{escape_name(topic)}', as it contains more than one type: [{names}]")
    return types[0] if types else None


def _not_published(topic: str) -> str:
    """Return the warning that ``ros2`` prints about a topic that does not exist."""
    return f"WARNING: topic [{escape_name(topic)}] does not appear to be published yet"


def _rate_text(intervals: deque[float]) -> str:
    """Return the two lines that ``ros2 topic hz`` prints."""
    times = np.array(intervals)
    mean = times.mean()
    return (
        f"average rate: {1 / mean if mean > 0 else 0.0:.3f}\n"
        f"\tmin: {times.min():.3f}s max: {times.max():.3f}s std dev: {times.std():.5f}s window: {len(times)}\n"
    )
