"""Publish one message repeatedly, and yield the output of ``ros2 topic pub`` as text, without printing it.

The node must be spinning on its own thread (`tutorial.ros.node_thread.NodeThread`).
"""

import asyncio
import time
from collections.abc import AsyncGenerator
from itertools import count

from rclpy.duration import Duration
from rclpy.node import Node

from tutorial.errors import TutorialError
from tutorial.ros.topics.names import full_topic
from tutorial.ros.topics.populate import Populated

DEPTH = 10  # depth of the queue, as in rclpy's default profile
LOOK_EVERY = 0.1  # [s] between checks for subscriptions
TELL_EVERY = 10  # number of checks between two messages about the wait
KEEP_ALIVE = 0.1  # [s] how long the publisher stays alive after its last message, as in ros2
ACKNOWLEDGED_IN = 1.0  # [s] maximum time to wait for acknowledgements


async def topic_pub(
    node: Node, topic: str, populated: Populated, rate: float = 1.0, once: bool = False
) -> AsyncGenerator[str, None]:
    """Publish a message repeatedly, like ``ros2 topic pub``. Yield the line about each message before publishing it.

    Args:
        node: the node that publishes.
        topic: its name.
        populated: the message to publish; its stamps are set to the node's time before each publication.
        rate: how often to publish [Hz].
        once: wait for a subscription and publish once, instead of publishing forever.

    Yields:
        The text that ``ros2 topic pub`` would print, line by line.

    Raises:
        TutorialError: the topic's name breaks ROS 2's naming rules; the error text is the same as in ROS 2.
    """
    message = populated.message
    try:
        publisher = node.create_publisher(type(message), full_topic(node, topic), DEPTH)
    except RuntimeError as error:
        raise TutorialError(str(error)) from error
    try:
        for look in count() if once else ():
            if publisher.get_subscription_count():
                break
            if look % TELL_EVERY == 0:
                yield "Waiting for at least 1 matching subscription(s)...\n"
            await asyncio.sleep(LOOK_EVERY)
        yield "publisher: beginning loop\n"
        due = time.monotonic()
        for number in count(1):
            populated.stamp(node.get_clock().now().to_msg())
            yield f"publishing #{number}: {message!r}\n\n"
            publisher.publish(message)
            if once:
                break
            due = max(due + 1 / rate, time.monotonic())  # don't make up for a delay
            await asyncio.sleep(due - time.monotonic())
        await asyncio.to_thread(publisher.wait_for_all_acked, Duration(seconds=ACKNOWLEDGED_IN))
        await asyncio.sleep(KEEP_ALIVE)
    finally:
        node.destroy_publisher(publisher)
