"""From publication to callback, between two processes: a node's callback, plain Cyclone DDS Python, and a real rclpy.

All publish the same message reliably, ``traffic.py publish|subscribe node|plain beat|flood|cost``: 100 times a second,
with the time as a stamp in it; or as fast as they can, and those that arrive are counted.
"""

import statistics
import sys
import time
from collections.abc import Callable
from typing import Any

import tutorial  # noqa: F401 - promises an rclpy

MESSAGES = 300
WARM_UP = 50
PERIOD = 0.01  # [s]
FLOOD = 2.0  # [s] for which those that arrive are counted
JOINTS, NUMBERS = ["TURRET_Y", "TURRET_P"], [0.1, 0.2]


def node_publisher() -> tuple[Callable[..., Any], ...]:
    """Publish with rclpy: what makes a message of a stamp, what serialises it, what sends it, and who listens."""
    import rclpy
    from rclpy.serialization import serialize_message
    from sensor_msgs.msg import JointState

    rclpy.init(args=[])
    publisher = rclpy.create_node("publisher").create_publisher(JointState, "bench", 10)

    def message(*stamp: int) -> Any:
        made = JointState(name=JOINTS, position=NUMBERS, velocity=NUMBERS, effort=NUMBERS)
        made.header.stamp.sec, made.header.stamp.nanosec = stamp
        return made

    return message, serialize_message, publisher.publish, publisher.get_subscription_count


def node_subscriber(add: Callable[[Any], None]) -> Callable[[], object]:
    """Receive with rclpy, on the thread that spins; return what waits for more."""
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from sensor_msgs.msg import JointState

    rclpy.init(args=[])
    node = rclpy.create_node("subscriber")
    node.create_subscription(JointState, "bench", lambda message: add(message.header.stamp), 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    return executor.spin_once


def plain_publisher() -> tuple[Callable[..., Any], ...]:
    """Publish with a DataWriter, and nothing of ROS 2."""
    import plain

    def serialized(message: Any) -> Any:
        data = message.serialize()
        message.serialize = lambda **_: data
        return message

    writer = plain.end(plain.DataWriter)
    return plain.message, serialized, writer.write, writer.get_matched_subscriptions


def plain_subscriber(add: Callable[[Any], None]) -> Callable[[], object]:
    """Receive with a DataReader and a WaitSet; return what waits for more."""
    import plain

    reader = plain.end(plain.DataReader)
    waitset = plain.waitset(reader)

    def wait() -> None:
        waitset.wait(100_000_000)
        for message in reader.take(1):
            if message.sample_info.valid_data:
                add(message.header.stamp)

    return wait


def publish(kind: str, pace: str) -> None:
    """Publish for ever. A flood is serialised already: so whoever receives it is the slower one."""
    message, serialized, send, listeners = {"node": node_publisher, "plain": plain_publisher}[kind]()
    while not listeners():
        time.sleep(0.01)
    while True:
        time.sleep(PERIOD)
        made = message(*divmod(time.time_ns(), 1_000_000_000))
        if pace != "beat":
            made = serialized(made)
            while True:
                send(made)
        send(made)


def subscribe(kind: str, pace: str) -> None:
    """Print the median age of a message, or what one takes, on the clock or of this thread's processor [s]."""
    ages: list[int] = []  # [ns]
    began = began_cpu = 0.0

    def add(stamp: Any) -> None:
        nonlocal began, began_cpu
        if not ages:
            began, began_cpu = time.monotonic(), time.thread_time()
        ages.append(time.time_ns() - stamp.sec * 1_000_000_000 - stamp.nanosec)

    wait = {"node": node_subscriber, "plain": plain_subscriber}[kind](add)
    while not ages or (len(ages) < MESSAGES if pace == "beat" else time.monotonic() < began + FLOOD):
        wait()
    took = time.thread_time() - began_cpu if pace == "cost" else time.monotonic() - began
    print(statistics.median(ages[WARM_UP:]) / 1e9 if pace == "beat" else took / len(ages))


if __name__ == "__main__":
    {"publish": publish, "subscribe": subscribe}[sys.argv[1]](*sys.argv[2:])
