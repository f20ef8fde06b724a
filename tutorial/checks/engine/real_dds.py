"""Real DDS: the last check, which tries a right answer on rclpy's own node."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rclpy.node import Node

from tutorial.errors import TutorialError
from tutorial.ros.node_thread import SpinThread

TIMEOUT = 10.0  # [s]; a wait takes this long only if the event never happens


@contextmanager
def ros_node() -> Iterator[Any]:
    """Make a node whose callbacks run on a separate thread."""
    with SpinThread(Node, "tank") as thread:
        yield thread.node


def send(node: Any, topic: str, message: Any, done: Callable[[], object]) -> None:
    """Publish a message to the learner's subscription, and wait until the message has an effect.

    Args:
        node: the learner's node.
        topic: the topic.
        message: the message.
        done: returns whether the message has had an effect.

    Raises:
        TutorialError: the message does not arrive, or has no effect.
    """
    publisher = node.create_publisher(type(message), topic, 10)
    wait(
        publisher.get_subscription_count,
        "no message reaches the subscription. As its QoS, pass only a queue depth, such as 1.",
    )
    publisher.publish(message)
    wait(done, "a message from another program has no effect")


def wait(condition: Callable[[], object], complaint: str) -> None:
    """Wait until a condition is true.

    Raises:
        TutorialError: the condition stays false for too long; `complaint` is the error message.
    """
    deadline = time.monotonic() + TIMEOUT
    while not condition():
        if time.monotonic() > deadline:
            raise TutorialError(complaint)
        time.sleep(0.0005)
