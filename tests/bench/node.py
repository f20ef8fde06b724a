"""Implement both ends with rclpy: the pocket one, or a real one."""

from collections.abc import Callable
from typing import Any

import tutorial  # noqa: F401 - makes rclpy importable

# isort: split
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

rclpy.init(args=[])
made = rclpy.create_node("bench")


def publisher() -> tuple[Any, Callable[..., Any], Callable[..., Any], Callable[[], int]]:
    """Return a message and the functions that serialize it, send it, and count the listeners."""
    publisher = made.create_publisher(JointState, "bench", 10)
    return JointState(), serialize_message, publisher.publish, publisher.get_subscription_count


def subscriber(add: Callable[[Any], None]) -> Callable[[], object]:
    """Call `add` with each message on the spinning thread; return the function that waits for more."""
    made.create_subscription(JointState, "bench", add, 10)
    executor = SingleThreadedExecutor()
    executor.add_node(made)
    return executor.spin_once
