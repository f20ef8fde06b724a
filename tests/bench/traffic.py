"""From publication to callback, between two processes, by rclpy: the embedded one's or a real one's.

``traffic.py publish|subscribe beat|flood|cost`` publishes the same message reliably: 100 times a second, with the time
as a stamp in it; or as fast as it can, and those that arrive are counted.
"""

import statistics
import sys
import time

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
JOINTS, NUMBERS = ["TURRET_Y", "TURRET_P"], [0.1, 0.2]


def publish(pace: str) -> None:
    """Publish for ever. A flood is serialised already: so whoever receives it is the slower one."""
    publisher = rclpy.create_node("publisher").create_publisher(JointState, "bench", 10)
    while not publisher.get_subscription_count():
        time.sleep(0.01)
    while True:
        time.sleep(PERIOD)
        message = JointState(name=JOINTS, position=NUMBERS, velocity=NUMBERS, effort=NUMBERS)
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(time.time_ns(), 1_000_000_000)
        if pace != "beat":
            data = serialize_message(message)
            while True:
                publisher.publish(data)
        publisher.publish(message)


def subscribe(pace: str) -> None:
    """Print the median age of a message, or what one takes, on the clock or of this thread's processor [s]."""
    ages: list[int] = []  # [ns]
    began = began_cpu = 0.0

    def add(message: JointState) -> None:
        nonlocal began, began_cpu
        if not ages:
            began, began_cpu = time.monotonic(), time.thread_time()
        stamp = message.header.stamp
        ages.append(time.time_ns() - stamp.sec * 1_000_000_000 - stamp.nanosec)

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
