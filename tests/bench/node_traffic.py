"""A node that publishes, or one that receives, with whichever rclpy there is: ``node_traffic.py beat publish``."""

import sys
import time

import tutorial  # noqa: F401 - promises an rclpy

# isort: split
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.serialization import serialize_message
from sensor_msgs.msg import JointState
from traffic_log import FLOODS, Log, flood, stamps


def publish() -> None:
    """Publish with rclpy."""
    rclpy.init(args=[])
    node = rclpy.create_node("publisher")
    publisher = node.create_publisher(JointState, "bench", 10)
    while rclpy.ok() and not publisher.get_subscription_count():
        time.sleep(0.01)
    for stamp in stamps():
        message = JointState(name=["TURRET_Y", "TURRET_P"], position=[0.1, 0.2], velocity=[0.1, 0.2], effort=[0.1, 0.2])
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, 1_000_000_000)
        if FLOODS:
            flood(publisher.publish, serialize_message(message))
        publisher.publish(message)


def subscribe() -> None:
    """Receive with rclpy, on the thread that spins."""

    rclpy.init(args=[])
    node = rclpy.create_node("subscriber")
    log = Log()
    node.create_subscription(JointState, "bench", lambda message: log.add(message.header.stamp), 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    while not log.full:
        executor.spin_once()
    log.finish()


if __name__ == "__main__":
    {"publish": publish, "subscribe": subscribe}[sys.argv[2]]()
