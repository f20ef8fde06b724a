"""Publishing one message again and again: ``ros2 topic pub``, as text.

The node that publishes has a thread of its own, `tutorial.ros.node_thread.NodeThread`. Nothing here prints.
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

DEPTH = 10  # of the queue, as of rclpy's default profile
LOOK_EVERY = 0.1  # [s] for subscriptions
TELL_EVERY = 10  # of these looks
KEEP_ALIVE = 0.1  # [s] after the last message, as ros2 does
ACKNOWLEDGED_IN = 1.0  # [s] at most


async def topic_pub(
    node: Node, topic: str, populated: Populated, rate: float = 1.0, once: bool = False
) -> AsyncGenerator[str, None]:
    """Publish a message, as ``ros2 topic pub``. Each text comes before the message that it announces is published.

    Args:
        node: that publishes.
        topic: its name.
        populated: what to publish; its stamps are set to the node's time before each publication.
        rate: how often [Hz].
        once: wait for a subscription, and publish to it once; else it goes on for ever.

    Yields:
        What ``ros2 topic pub`` prints.

    Raises:
        TutorialError: the topic's name breaks the rules for names; the text is that of ROS 2.
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
            due = max(due + 1 / rate, time.monotonic())  # after a delay it does not hurry
            await asyncio.sleep(due - time.monotonic())
        await asyncio.to_thread(publisher.wait_for_all_acked, Duration(seconds=ACKNOWLEDGED_IN))
        await asyncio.sleep(KEEP_ALIVE)
    finally:
        node.destroy_publisher(publisher)
