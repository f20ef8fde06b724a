"""One case of an exercise on real DDS: the learner's controller on rclpy's own node, with its thread."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rclpy.node import Node

from tutorial.errors import TutorialError
from tutorial.ros.node_thread import SpinThread

__all__ = ["ros_node", "send", "wait"]

PATIENCE = 10.0  # [s]; only what never comes takes so long


@contextmanager
def ros_node() -> Iterator[Any]:
    """Make a node whose callbacks run on a thread of its own."""
    with SpinThread(Node, "tank") as thread:
        yield thread.node


def send(node: Any, topic: str, message: Any, done: Callable[[], object]) -> None:
    """Publish a message for the learner's subscription, and wait until something has come of it.

    Args:
        node: the learner's.
        topic: the topic.
        message: what to publish.
        done: whether something has come of it.

    Raises:
        TutorialError: the message does not arrive.
    """
    publisher = node.create_publisher(type(message), topic, 10)
    wait(publisher.get_subscription_count, "no message reaches the subscription. Is its QoS 1?")
    publisher.publish(message)
    wait(done, "nothing comes of a message from another program")


def wait(condition: Callable[[], object], complaint: str) -> None:
    """Wait until something is so.

    Raises:
        TutorialError: it never is, with the complaint.
    """
    deadline = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > deadline:
            raise TutorialError(complaint)
        time.sleep(0.0005)
