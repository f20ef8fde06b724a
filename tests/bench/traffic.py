"""From publication to callback, between two processes: with the pocket ROS 2, and with a real rclpy.

Both publish the same message reliably, ``traffic.py publish|subscribe beat|flood|cost``: 100 times a second, with the
time as a stamp in it; or as fast as they can, and those that arrive are counted.
"""

import statistics
import sys
import time
from typing import Any

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState

MESSAGES = 300
WARM_UP = 50
PERIOD = 0.01  # [s]
FLOOD = 2.0  # [s] for which those that arrive are counted
NUMBERS = [0.1, 0.2]


def publish(pace: str) -> None:
    """Publish for ever. A flood is serialised already: so whoever receives it is the slower one."""
    publisher = rclpy.create_node("publisher").create_publisher(JointState, "bench", 10)
    message = JointState(name=["TURRET_Y", "TURRET_P"], position=NUMBERS, velocity=NUMBERS, effort=NUMBERS)
    while not publisher.get_subscription_count():
        time.sleep(0.01)
    while True:
        time.sleep(PERIOD)
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
        if pace != "beat":
            serialized = serialize_message(message)
            while True:
                publisher.publish(serialized)
        publisher.publish(message)


def subscribe(pace: str) -> None:
    """Print the median age of a message, or what one takes, on the clock or of this thread's processor [s]."""
    ages: list[int] = []  # [ns]
    began = began_cpu = 0.0

    def add(message: Any) -> None:
        nonlocal began, began_cpu
        if not ages:
            began, began_cpu = time.monotonic(), time.thread_time()
        ages.append(time.time_ns() - message.header.stamp.sec * 1_000_000_000 - message.header.stamp.nanosec)

    node = rclpy.create_node("subscriber")
    node.create_subscription(JointState, "bench", add, 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    while not ages or (len(ages) < MESSAGES if pace == "beat" else time.monotonic() < began + FLOOD):
        executor.spin_once()
    took = time.thread_time() - began_cpu if pace == "cost" else time.monotonic() - began
    print(statistics.median(ages[WARM_UP:]) / 1e9 if pace == "beat" else took / len(ages))


if __name__ == "__main__":
    rclpy.init(args=[])
    {"publish": publish, "subscribe": subscribe}[sys.argv[1]](sys.argv[2])
