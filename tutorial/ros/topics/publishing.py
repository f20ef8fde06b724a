"""Publishing one message again and again: ``ros2 topic pub``, as text.

The node that publishes has a thread of its own, `tutorial.ros.node_thread.NodeThread`. Nothing here prints.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncGenerator, Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile

from tutorial.errors import TutorialError
from tutorial.ros.topics.names import full_topic
from tutorial.ros.topics.populate import Stamp

__all__ = ["topic_pub"]

LOOK_EVERY = 0.1  # [s] for subscriptions
TELL_EVERY = 10  # of these looks
KEEP_ALIVE = 0.1  # [s] after the last message, as ros2 does
ACKNOWLEDGED_IN = 1.0  # [s] at most


async def topic_pub(
    node: Node,
    topic: str,
    message: Any,
    stamps: Sequence[Stamp],
    *,
    qos: QoSProfile,
    rate: float = 1.0,
    times: int = 0,
    wait: int = 0,
    print_every: int = 1,
) -> AsyncGenerator[str, None]:
    """Publish a message, as ``ros2 topic pub``. Each text comes before the message that it announces is published.

    Args:
        node: that publishes.
        topic: its name.
        message: what to publish.
        stamps: called with the time before each publication.
        qos: what to offer.
        rate: how often [Hz].
        times: how many times; 0 goes on for ever.
        wait: for how many subscriptions to wait first.
        print_every: announce only each n-th message; 0 for none.

    Yields:
        What ``ros2 topic pub`` prints.

    Raises:
        TutorialError: the topic's name breaks the rules for names; the text is that of ROS 2.
    """
    try:
        publisher = node.create_publisher(type(message), full_topic(node, topic), qos)
    except RuntimeError as error:
        raise TutorialError(str(error)) from error
    try:
        async for text in _meeting(publisher, wait):
            yield text
        yield "publisher: beginning loop\n"
        async for count in _beats(rate, times):
            now = node.get_clock().now().to_msg()
            for stamp in stamps:
                stamp(now)
            if print_every and count % print_every == 0:
                yield f"publishing #{count}: {message!r}\n\n"
            publisher.publish(message)
        await asyncio.to_thread(publisher.wait_for_all_acked, Duration(seconds=ACKNOWLEDGED_IN))
        await asyncio.sleep(KEEP_ALIVE)
    finally:
        node.destroy_publisher(publisher)


async def _meeting(publisher: Any, wanted: int) -> AsyncGenerator[str, None]:
    """Wait for so many subscriptions, and say so once a second."""
    looks = 0
    while publisher.get_subscription_count() < wanted:
        if looks % TELL_EVERY == 0:
            yield f"Waiting for at least {wanted} matching subscription(s)...\n"
        looks += 1
        await asyncio.sleep(LOOK_EVERY)


async def _beats(rate: float, times: int) -> AsyncGenerator[int, None]:
    """Count from 1 at a rate [Hz], up to so many times, or for ever for 0; after a delay it does not hurry."""
    count, due = 1, time.monotonic()
    yield count
    while count != times:
        due = max(due + 1 / rate, time.monotonic())
        await asyncio.sleep(due - time.monotonic())
        count += 1
        yield count
